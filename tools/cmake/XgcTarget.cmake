# Compiler settings that all targets of the project share. Floating-point contraction is off everywhere: the same
# input gives the same bytes with and without FMA. xgc_target(NAME [PRIVATE]): PRIVATE where users need no C++20.
function(xgc_target target)
  if(ARGV1 STREQUAL "PRIVATE")
    target_compile_features(${target} PRIVATE cxx_std_20)
  else()
    target_compile_features(${target} PUBLIC cxx_std_20)
  endif()
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF C_STANDARD 11 C_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                           -Wno-sign-conversion)
  if(XGC_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(XGC_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${XGC_SANITIZE} -fno-sanitize-recover=all
                                             -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${XGC_SANITIZE})
  endif()
  # Fuzzers look for new paths in the libraries, not in other programs.
  if(XGC_BUILD_FUZZERS AND target MATCHES "^(xgc_runtime|xgc_load|xgc_bake|fuzz_.*)$")
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# A program whose own code runs shortly beside what it calls, and takes long to compile: half of it where sanitizers would
# be optimised, a third of it else.
function(xgc_short_running target)
  if(XGC_SANITIZE)
    target_compile_options(${target} PRIVATE -O0)
  else()
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()
