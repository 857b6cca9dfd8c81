# RESIGHT_MARCH is the instruction set on x86-64. All parts of a program must be built for the same one: Eigen's
# alignment, and therefore our ABI, depends on it. The default is x86-64-v3 (AVX2, FMA) if the building machine can run
# it. Otherwise it is the default of the compiler, which every x86-64 processor can run.
set(default_march "")
if(NOT DEFINED RESIGHT_MARCH AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT CMAKE_CROSSCOMPILING)
  include(CheckCXXSourceRuns)
  check_cxx_source_runs("
    int main() {
      return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") && __builtin_cpu_supports(\"bmi2\") ? 0 : 1;
    }" RESIGHT_RUNS_X86_64_V3)
  if(RESIGHT_RUNS_X86_64_V3)
    set(default_march "x86-64-v3")
  else()
    message(STATUS "this machine has no AVX2: built for any x86-64 processor, a third slower")
  endif()
endif()
set(RESIGHT_MARCH "${default_march}" CACHE STRING
    "Instruction set on x86-64 (-march); empty for the compiler's own default")
