# Read by ctest for every program of tests: each suite is one test. Loading a program's
# libraries takes longer than most cases do.
function(nlos_add_suites folder label program)
  execute_process(COMMAND ${program} --gtest_list_tests
                  OUTPUT_VARIABLE list RESULT_VARIABLE failure)
  string(REGEX MATCHALL "\n[A-Za-z0-9_/]+\\." suites "\n${list}")
  if(failure OR NOT suites)
    add_test(${folder}.NOT_BUILT ${program})
    return()
  endif()
  foreach(suite ${suites})
    string(REGEX REPLACE "[\n.]" "" suite ${suite})
    add_test(${folder}.${suite} ${program} --gtest_filter=${suite}.*)
    set_tests_properties(${folder}.${suite} PROPERTIES LABELS "${label}")
  endforeach()
endfunction()
