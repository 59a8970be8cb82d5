// The number types of the formulas: 32-bit floats, or 16-bit floats where APERTURA_HALF is defined and
// GL_EXT_shader_explicit_arithmetic_types_float16 is enabled. It may be included again for the other type. C++ has its
// own types in sh/shading.h.
//   lpsmall(x)  a small number that keeps a quotient finite; in 16 bits, the least normal number
//   lplarge(x)  a number beyond all others; in 16 bits, a number whose square is still finite
#undef lpfloat
#undef lpvec2
#undef lpvec3
#undef lpvec4
#undef lpsmall
#undef lplarge
#ifdef APERTURA_HALF
#define lpfloat float16_t
#define lpvec2 f16vec2
#define lpvec3 f16vec3
#define lpvec4 f16vec4
#define lpsmall(x) lpfloat(6.2e-5)
#define lplarge(x) lpfloat(180.0)
#else
#define lpfloat float
#define lpvec2 vec2
#define lpvec3 vec3
#define lpvec4 vec4
#define lpsmall(x) float(x)
#define lplarge(x) float(x)
#endif
