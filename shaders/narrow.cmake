# A text of this folder with 16-bit floats for 32-bit ones: cmake -DFROM=cap.glsl -DTO=half/cap.glsl -P narrow.cmake
# Small numbers that keep a quotient finite become the smallest normal one, and large ones those whose square is still a
# number: a half holds 6.1e-5 to 65504.
file(READ "${FROM}" text)
string(REPLACE ";" "@SEMICOLON@" text "${text}")
string(REGEX REPLACE "1e-([5-9]|[1-9][0-9])f" "6.2e-5hf" text "${text}")
string(REGEX REPLACE "1e([5-9]|[1-9][0-9])f" "180.0hf" text "${text}")
string(REGEX REPLACE "([0-9]\\.[0-9]*)f" "\\1hf" text "${text}")
string(REGEX REPLACE "(1e-[0-9]+)f" "\\1hf" text "${text}")
string(REGEX REPLACE "([^A-Za-z0-9_])float([^A-Za-z0-9_])" "\\1float16_t\\2" text "${text}")
string(REGEX REPLACE "([^A-Za-z0-9_])vec([234][^A-Za-z0-9_])" "\\1f16vec\\2" text "${text}")
string(REGEX REPLACE "([^A-Za-z0-9_])vec([234][^A-Za-z0-9_])" "\\1f16vec\\2" text "${text}")
string(REGEX REPLACE "([^A-Za-z0-9_])float([^A-Za-z0-9_])" "\\1float16_t\\2" text "${text}")
string(REGEX MATCH "[^A-Za-z_][0-9.]+(e-?[0-9]+)?f[^A-Za-z0-9_]" left "${text}")
if(left)
  message(FATAL_ERROR "${FROM}: a 32-bit number is left: ${left}")
endif()
string(REPLACE "@SEMICOLON@" ";" text "${text}")
file(WRITE "${TO}" "${text}")
