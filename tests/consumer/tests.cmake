# A real consumer, built and run in each way that Pintle can be had, for each precision. What is built is kept, so that
# a second run only builds what changed. Unity builds save most of the time, and are what some consumers set.

add_test(NAME consumer.install
  COMMAND "${CMAKE_COMMAND}" --install "${PROJECT_BINARY_DIR}" --config $<CONFIG>
          --prefix "${CMAKE_CURRENT_BINARY_DIR}/consumer/prefix")
set_tests_properties(consumer.install PROPERTIES FIXTURES_SETUP installed LABELS consumer)

foreach(way package headers subdirectory bullet_sources)
  foreach(precision IN LISTS PINTLE_PRECISIONS)
    string(TOUPPER ${precision} PRECISION)
    set(bullet "")
    foreach(part INCLUDE_DIR BulletDynamics_LIBRARY BulletCollision_LIBRARY LinearMath_LIBRARY)
      list(APPEND bullet "-DPINTLE_BULLET_${PRECISION}_${part}=${PINTLE_BULLET_${PRECISION}_${part}}")
    endforeach()

    set(test consumer.${way}.${precision})
    set(build_dir "${CMAKE_CURRENT_BINARY_DIR}/consumer/${way}_${precision}")
    add_test(NAME ${test}
      COMMAND "${CMAKE_CTEST_COMMAND}" --build-and-test "${CMAKE_CURRENT_SOURCE_DIR}/consumer" "${build_dir}"
              --build-generator "${CMAKE_GENERATOR}" --build-config $<CONFIG> --build-noclean --build-target consumer
              --build-options -DWAY=${way} -DPRECISION=${precision}
                "-DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=24
                "-Dpintle_ROOT=${CMAKE_CURRENT_BINARY_DIR}/consumer/prefix" "-DEigen3_DIR=${Eigen3_DIR}" ${bullet}
              --test-command consumer)
    # They take longest: first come, and nothing waits for them at the end.
    set_tests_properties(${test} PROPERTIES LABELS consumer COST 1000 ENVIRONMENT MAKEFLAGS=-j2)
    if(way MATCHES "package|headers")
      set_tests_properties(${test} PROPERTIES FIXTURES_REQUIRED installed)
    endif()
  endforeach()
endforeach()
