# resight_add_module(NAME [DEPS module...] [PUBLIC_LIBS lib...] [PRIVATE_LIBS lib...]
#                    [TEST_DEPS module...] [TEST_LIBS lib...])
#
# Each folder is one target `resight::NAME`. Its *.cpp are the sources, its *.hpp the installed headers, and its
# *_test.cpp the tests (one executable `resight_NAME_test`). A module may depend only on modules that precede it in
# RESIGHT_LAYERS; any other edge is a configure error, and so is a difference between DEPS and the includes. TEST_DEPS
# may lie higher and serve the tests only.
set(RESIGHT_LAYERS
    core
    geometry appearance
    sensor segmentation recordings
    io rendering features evidence
    registration models changes simulation
    hypotheses history reconstruction training cameras inspection
    verification shape_search modelling
    recognition
    evaluation
    report annotation
    viewer)

add_library(resight_build_flags INTERFACE)
if(RESIGHT_MARCH AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # Consumers inherit this option: Eigen's alignment, and therefore our ABI, depends on the instruction set.
  target_compile_options(resight_build_flags INTERFACE -march=${RESIGHT_MARCH})
endif()
if(RESIGHT_SANITIZE)
  target_compile_options(resight_build_flags INTERFACE -fsanitize=${RESIGHT_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(resight_build_flags INTERFACE -fsanitize=${RESIGHT_SANITIZE})
endif()

# Warnings and code generation of our own files; consumers do not inherit them. -ffast-math is not used, because NaN
# means "no measurement".
function(resight_private_flags target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wconversion
                                           -Wno-sign-conversion -fno-math-errno -fno-trapping-math)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # False alarms: in Eigen and in moved strings, and for classes that a joined source file keeps to itself.
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow
                                             -Wno-stringop-overread -Wno-subobject-linkage)
  endif()
  if(RESIGHT_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# The code of a test runs once, so most optimisation of it costs more time than it saves. The libraries under test are
# compiled as they are for use. Expensive optimisations include fused multiplication and addition: with them, a test that
# computes what the library computes gets the same bits.
function(resight_test_flags target)
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-O1;-fexpensive-optimizations>")
endfunction()

# Joins the sources of a target into larger translation units (RESIGHT_UNITY_BUILD) and gives it a precompiled header.
# The compiler spends two thirds of its time on the same headers, so a clean build becomes three times as fast. Names in
# anonymous namespaces must therefore be unique among the sources of a module, and among its tests.
function(resight_speed_up_build target)
  cmake_parse_arguments(ARG "" "REUSE_FROM" "" ${ARGN})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${RESIGHT_UNITY_BUILD}
                                             UNITY_BUILD_BATCH_SIZE ${RESIGHT_UNITY_BATCH_SIZE})
  if(RESIGHT_PRECOMPILED_HEADERS AND ARG_REUSE_FROM)
    target_precompile_headers(${target} REUSE_FROM ${ARG_REUSE_FROM})
    target_include_directories(${target} SYSTEM PRIVATE # of the precompiled header, for tools that read it anew
                               $<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>)
  endif()
endfunction()

# A target that only holds a precompiled header. A reused header must be compiled with the flags of its users. Libraries
# share one header (-fPIC), test programs another (-fPIE, with gmock).
function(resight_add_precompiled_header target kind header)
  cmake_parse_arguments(ARG "" "" "LIBS" ${ARGN})
  set(source ${CMAKE_BINARY_DIR}/precompiled/${target}.cpp)
  if(kind STREQUAL "EXECUTABLE")
    file(CONFIGURE OUTPUT ${source} CONTENT "int main() { return 0; }\n")
    add_executable(${target} EXCLUDE_FROM_ALL ${source})
    resight_test_flags(${target})
  else()
    file(CONFIGURE OUTPUT ${source} CONTENT "namespace resight { extern const int ${target}; }\n")
    add_library(${target} OBJECT EXCLUDE_FROM_ALL ${source})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  resight_private_flags(${target})
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_link_libraries(${target} PRIVATE resight_build_flags ${ARG_LIBS})
  target_precompile_headers(${target} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/${header})
endfunction()
if(RESIGHT_PRECOMPILED_HEADERS)
  resight_add_precompiled_header(resight_pch OBJECT precompiled.hpp LIBS Eigen3::Eigen)
  if(RESIGHT_BUILD_TESTS)
    resight_add_precompiled_header(resight_test_pch EXECUTABLE precompiled_test.hpp LIBS Eigen3::Eigen GTest::gmock)
  endif()
endif()

# Compares the includes of a module with its DEPS, and those of its tests with DEPS and TEST_DEPS: all modules share one
# include root, so the compiler accepts an include of any module. DEPS that no file includes are errors, too.
function(resight_check_includes name deps test_deps)
  file(GLOB_RECURSE files *.cpp *.hpp)
  foreach(file IN LISTS files)
    file(STRINGS ${file} includes REGEX "^#include \"resight/")
    list(TRANSFORM includes REPLACE "^#include \"resight/([^/]+)/.*" "\\1")
    if(file MATCHES "/testing/|test[^/]*\\.(hpp|cpp)$")
      list(APPEND included_by_tests ${includes})
    else()
      list(APPEND included ${includes})
    endif()
  endforeach()
  list(REMOVE_ITEM included ${name})
  list(REMOVE_DUPLICATES included)
  list(REMOVE_ITEM included_by_tests ${name} ${deps})
  list(REMOVE_DUPLICATES included_by_tests)
  resight_compare_lists("${name}" DEPS "${deps}" "${included}")
  resight_compare_lists("${name}" TEST_DEPS "${test_deps}" "${included_by_tests}")
endfunction()

function(resight_compare_lists name keyword declared included)
  set(undeclared ${included})
  list(REMOVE_ITEM undeclared ${declared})
  set(unused ${declared})
  list(REMOVE_ITEM unused ${included})
  if(undeclared OR unused)
    message(SEND_ERROR "resight module '${name}', ${keyword}: included but not declared: [${undeclared}]; "
                        "declared but not included: [${unused}]")
  endif()
endfunction()

if(RESIGHT_BUILD_TESTS)
  add_custom_target(resight_unit_tests) # builds the tests of all modules
endif()

function(resight_add_module name)
  cmake_parse_arguments(ARG "" "" "DEPS;PUBLIC_LIBS;PRIVATE_LIBS;TEST_DEPS;TEST_LIBS" ${ARGN})
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

  resight_check_includes(${name} "${ARG_DEPS}" "${ARG_TEST_DEPS}")

  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  file(GLOB headers CONFIGURE_DEPENDS *.hpp)
  list(FILTER headers EXCLUDE REGEX "test[^/]*\\.hpp$") # test helpers are not installed
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
    resight_speed_up_build(${target} REUSE_FROM resight_pch)
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
  set_property(GLOBAL APPEND PROPERTY RESIGHT_MODULE_EDGES "${name} -> {${ARG_DEPS}}")

  if(RESIGHT_BUILD_TESTS AND tests)
    list(TRANSFORM ARG_TEST_DEPS PREPEND resight_)
    resight_add_test(${name} SOURCES ${tests} LIBS ${target} ${ARG_TEST_DEPS} ${ARG_PRIVATE_LIBS} ${ARG_TEST_LIBS})
    add_dependencies(resight_unit_tests ${target}_test)
  endif()
endfunction()

# Writes modules.dot into the build folder: each module and its declared dependencies, for scripts/draw_modules.sh.
function(resight_write_module_graph)
  get_property(edges GLOBAL PROPERTY RESIGHT_MODULE_EDGES)
  string(REPLACE ";" " " edges "${edges}")
  string(REPLACE "} " "}\n" edges "${edges}")
  file(CONFIGURE OUTPUT modules.dot CONTENT "digraph modules {\n@edges@\n}\n" @ONLY)
endfunction()

# resight_add_test(NAME SOURCES file... LIBS lib... [DEFINITIONS definition...] [LABEL label] [TIMEOUT s]): the GoogleTest
# executable resight_NAME_test and one ctest entry for all of its cases, because the start of a program with the
# libraries of OpenCV takes longer than most cases.
function(resight_add_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;LIBS;DEFINITIONS" ${ARGN})
  foreach(default LABEL=unit TIMEOUT=600)
    string(REGEX MATCH "(.*)=(.*)" _ ${default})
    if(NOT ARG_${CMAKE_MATCH_1})
      set(ARG_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
    endif()
  endforeach()
  set(target resight_${name}_test)
  add_executable(${target} ${ARG_SOURCES})
  resight_private_flags(${target})
  resight_test_flags(${target})
  resight_speed_up_build(${target} REUSE_FROM resight_test_pch)
  target_link_libraries(${target} PRIVATE ${ARG_LIBS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${target} PRIVATE RESIGHT_SHARED_DATA_DIR="${PROJECT_SOURCE_DIR}/../shared/data"
                                               RESIGHT_SOURCE_DIR="${PROJECT_SOURCE_DIR}" ${ARG_DEFINITIONS})
  add_test(NAME ${name} COMMAND ${target} --gtest_brief=1)
  set_tests_properties(${name} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
