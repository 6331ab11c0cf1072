# cmake -DNM=nm -DARCHIVE=libxgc_runtime.a -DSOURCES=runtime -P runtime_purity.cmake
# The runtime core is the standard library and GLM: it throws nothing, has no RTTI, reads no file, prints nothing and
# starts no thread. Looks for forbidden names in what the archive defines and wants, and for foreign includes.
execute_process(COMMAND ${NM} -C ${ARCHIVE} OUTPUT_VARIABLE symbols RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT symbols MATCHES "xgc::buildIndices")
  message(FATAL_ERROR "${ARCHIVE}: nm found no xgc::buildIndices in it")
endif()
set(forbidden __cxa_throw __cxa_allocate_exception __cxa_begin_catch __dynamic_cast "typeinfo for" "vtable for"
    "U fopen" "U open" "U fwrite" "U write" "U printf" "U fprintf" "U puts" "U snprintf" "std::basic_ostream" "std::cout"
    "std::basic_fstream" "std::filesystem" "std::thread" "U pthread_create" "U getenv" "U dlopen" "U vk")
set(found "")
foreach(name ${forbidden})
  string(FIND "${symbols}" "${name}" at)
  if(NOT at EQUAL -1)
    string(APPEND found "\n  ${name}")
  endif()
endforeach()
if(found)
  message(FATAL_ERROR "${ARCHIVE} uses what the runtime core must not:${found}")
endif()

# Headers of the standard library that bring files, streams, threads or locales.
set(foreign "[<\"](fstream|iostream|istream|ostream|sstream|iosfwd|filesystem|thread|mutex|future|locale|regex|cstdio|stdio\\.h|vulkan[^>]*)[>\"]")
file(GLOB files ${SOURCES}/include/xgc/*.h ${SOURCES}/src/*.h ${SOURCES}/src/*.cpp)
foreach(file ${files})
  file(STRINGS ${file} includes REGEX "^ *# *include")
  foreach(include ${includes})
    if(include MATCHES "${foreign}" OR
       (include MATCHES "<[^>]*[./][^>]*>" AND NOT include MATCHES "<((xgc|glm)/|emmintrin.h>|std(def|int).h>)"))
      message(FATAL_ERROR "${file}: ${include}: the runtime core includes the standard library, GLM and the compiler's SSE2 only")
    endif()
  endforeach()
endforeach()
