# resight_add_module(NAME [DEPS module...] [PUBLIC_LIBS lib...] [PRIVATE_LIBS lib...])
#
# One folder = one target `resight::NAME`: its *.cpp are the sources, its *.hpp the installed headers, its *_test.cpp
# the tests (one executable `resight_NAME_test`). A module may depend only on modules that stand before it in
# RESIGHT_LAYERS: an upward edge is a configure error.
set(RESIGHT_LAYERS
    core geometry sensor io simulation features models changes reconstruction hypotheses cameras modelling verification
    shape_search
    recognition evaluation report)

add_library(resight_build_flags INTERFACE)
if(RESIGHT_MARCH AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # Reaches consumers too: Eigen's alignment, and with it our ABI, hangs on the instruction set.
  target_compile_options(resight_build_flags INTERFACE -march=${RESIGHT_MARCH})
endif()
if(RESIGHT_SANITIZE)
  target_compile_options(resight_build_flags INTERFACE -fsanitize=${RESIGHT_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(resight_build_flags INTERFACE -fsanitize=${RESIGHT_SANITIZE})
endif()

# Warnings and code generation of our own files; never passed on. No -ffast-math: NaN means "no measurement" here.
function(resight_private_flags target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wconversion
                                           -Wno-sign-conversion -fno-math-errno -fno-trapping-math)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow) # false alarms in Eigen
  endif()
  if(RESIGHT_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

function(resight_add_module name)
  cmake_parse_arguments(ARG "" "" "DEPS;PUBLIC_LIBS;PRIVATE_LIBS" ${ARGN})
  list(FIND RESIGHT_LAYERS ${name} own_layer)
  if(own_layer EQUAL -1)
    message(FATAL_ERROR "resight module '${name}' has no place in RESIGHT_LAYERS")
  endif()
  foreach(dep IN LISTS ARG_DEPS)
    list(FIND RESIGHT_LAYERS ${dep} dep_layer)
    if(dep_layer EQUAL -1 OR NOT dep_layer LESS own_layer)
      message(FATAL_ERROR "resight module '${name}' may not depend on '${dep}': edges point down only")
    endif()
  endforeach()

  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  file(GLOB headers CONFIGURE_DEPENDS *.hpp)
  list(FILTER headers EXCLUDE REGEX "test[^/]*\\.hpp$") # helpers of tests are not installed
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")

  set(target resight_${name})
  if(sources)
    add_library(${target} STATIC ${sources})
    set(scope PUBLIC)
    resight_private_flags(${target})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(${target} PRIVATE ${ARG_PRIVATE_LIBS})
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(resight::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${target} ${scope} cxx_std_20)
  target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${headers})
  target_link_libraries(${target} ${scope} resight_build_flags ${ARG_PUBLIC_LIBS})
  foreach(dep IN LISTS ARG_DEPS)
    target_link_libraries(${target} ${scope} resight_${dep})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY RESIGHT_MODULES ${target})

  if(RESIGHT_BUILD_TESTS AND tests)
    resight_add_test(${target}_test SOURCES ${tests} LIBS ${target} ${ARG_PRIVATE_LIBS})
  endif()
endfunction()

# resight_add_test(NAME SOURCES file... LIBS lib... [LABELS label...]): a GoogleTest executable, one ctest entry a case.
function(resight_add_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  resight_private_flags(${name})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE RESIGHT_SHARED_DATA_DIR="${PROJECT_SOURCE_DIR}/../shared/data"
                                             RESIGHT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
                       PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
endfunction()
