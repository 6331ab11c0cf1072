# cmake -DINCLUDE=runtime/include -P c_header.cmake
# xgc.h compiles alone, in C11 and in C++20, with each compiler that is there; its structs have no padding.
set(tried 0)
foreach(compiler gcc clang g++ clang++)
  unset(program CACHE)
  find_program(program ${compiler})
  if(NOT program)
    continue()
  endif()
  set(language -x c -std=c11 -Wstrict-prototypes)
  if(compiler MATCHES "\\+\\+")
    set(language -x c++ -std=c++20)
  endif()
  execute_process(COMMAND ${program} ${language} -pedantic -Wall -Wextra -Wpadded -Werror -fsyntax-only
                          ${INCLUDE}/xgc/xgc.h
                  RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "xgc.h does not compile alone with ${compiler}")
  endif()
  math(EXPR tried "${tried} + 1")
endforeach()
if(tried LESS 2)
  message(FATAL_ERROR "found ${tried} compilers")
endif()
