// The number types of the formulas: 32-bit floats, or 16-bit floats where APERTURA_HALF is defined and
// GL_EXT_shader_explicit_arithmetic_types_float16 is enabled. It may be included again for the other type. C++ has its
// own types in sh/shading.h.
//   aperturaSmall(x)  a small number that keeps a quotient finite; in 16 bits, the least normal number
//   aperturaLarge(x)  a number beyond all others; in 16 bits, a number whose square is still finite
#undef AperturaFloat
#undef AperturaVec2
#undef AperturaVec3
#undef AperturaVec4
#undef aperturaSmall
#undef aperturaLarge
#ifdef APERTURA_HALF
#define AperturaFloat float16_t
#define AperturaVec2 f16vec2
#define AperturaVec3 f16vec3
#define AperturaVec4 f16vec4
#define aperturaSmall(x) AperturaFloat(6.2e-5)
#define aperturaLarge(x) AperturaFloat(180.0)
#else
#define AperturaFloat float
#define AperturaVec2 vec2
#define AperturaVec3 vec3
#define AperturaVec4 vec4
#define aperturaSmall(x) float(x)
#define aperturaLarge(x) float(x)
#endif
