# The functions that make Pintle's own targets, the same for each precision.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# The public headers of the solver.
set(PINTLE_SOLVER_HEADERS exact_joint_solver.h exact_joint_solver_pool.h exact_multi_body_joint_solver.h joint_solver.h
  sequential_joint_solver.h sequential_multi_body_joint_solver.h solver_options.h step_log.h step_report.h
  upgrading_solver.h uses_exact_solver.h)

# Warnings are private: what includes or links Pintle keeps its own.
function(pintle_set_warnings target)
  if(NOT MSVC)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor ${ARGN})
  endif()
  if(PINTLE_WARNINGS_AS_ERRORS AND NOT MSVC)
    # What gcc guesses after inlining is often wrong: a warning, but no error.
    target_compile_options(${target} PRIVATE -Werror 
      "$<$<CXX_COMPILER_ID:GNU>:-Wno-error=array-bounds;-Wno-error=maybe-uninitialized;-Wno-error=stringop-overflow>")
  endif()
endfunction()

# How the library's own code is compiled.
function(pintle_compile_library target precision)
  # No errno, no traps, and no function that a program may put in the place of one of these: none changes a number, and each costs in
  # a step. -O3 also with debug information.
  target_compile_options(${target} PRIVATE
    "$<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-fno-math-errno;-fno-trapping-math>"
    "$<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>"
    "$<$<AND:$<CXX_COMPILER_ID:GNU,Clang,AppleClang>,$<CONFIG:RelWithDebInfo>>:-O3>"
    # gcc packs loops over five rows for less than it costs, and vectors of three floats.
    "$<$<CXX_COMPILER_ID:GNU>:-fno-tree-loop-vectorize>"
    "$<$<AND:$<CXX_COMPILER_ID:GNU>,$<STREQUAL:${precision},single>>:-fno-tree-slp-vectorize>")
endfunction()

# pintle::<precision>, if `wanted` is ON, or AUTO and that Bullet was found. And pintle::extend_<precision>, for who
# writes joints of his own (pintle/extend.h): with Eigen, which the joints' own headers do not include.
function(pintle_add_library precision wanted)
  if(wanted STREQUAL "AUTO")
    set(wanted ${PintleBullet_${precision}_FOUND})
  endif()
  if(NOT wanted)
    return()
  endif()
  if(NOT PintleBullet_${precision}_FOUND)
    string(TOUPPER ${precision} PRECISION)
    message(FATAL_ERROR "Pintle: PINTLE_${PRECISION} is on, but no Bullet of ${precision} precision was found "
                        "(PINTLE_BULLET_${PRECISION}_ROOT can name where it is installed).")
  endif()

  file(GLOB_RECURSE sources CONFIGURE_DEPENDS
    "${PROJECT_SOURCE_DIR}/adapters/pintle/*.cpp" "${PROJECT_SOURCE_DIR}/plugin/pintle/*.cpp")
  # The solvers on Bullet's iterations need nothing of the exact one.
  set(sequential "${PROJECT_SOURCE_DIR}/plugin/pintle/solver/sequential_joint_solver.cpp")
  list(FILTER sources EXCLUDE REGEX "/pintle/solver/")
  list(APPEND sources "${sequential}")
  set(target pintle_${precision})
  add_library(${target} STATIC ${sources})
  add_library(pintle::${precision} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${precision} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_include_directories(${target} PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/adapters>"
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/plugin>"
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  # Where a program's recorder finds the page (pintle/record.h).
  target_compile_definitions(${target} INTERFACE
    "$<BUILD_INTERFACE:PINTLE_PAGE_TEMPLATE=\"${PROJECT_BINARY_DIR}/page/pintle_page.html\">"
    "$<INSTALL_INTERFACE:PINTLE_PAGE_TEMPLATE=\"$<INSTALL_PREFIX>/${CMAKE_INSTALL_DATADIR}/pintle/pintle_page.html\">")
  target_link_libraries(${target} PUBLIC PintleBullet::${precision} PRIVATE "$<BUILD_INTERFACE:Eigen3::Eigen>")
  add_library(pintle_extend_${precision} INTERFACE)
  add_library(pintle::extend_${precision} ALIAS pintle_extend_${precision})
  target_link_libraries(pintle_extend_${precision} INTERFACE ${target} Eigen3::Eigen)
  pintle_compile_library(${target} ${precision})
  if(NOT PintleBullet_${precision}_EXACT_SOLVER)
    message(STATUS "Pintle: this Bullet (${PintleBullet_${precision}_VERSION}, ${precision} precision) is older than 2.89: pintle::${precision} has "
                   "the joints and the recorder, but not the exact solver, whose base class has no convertJoints there.")
    pintle_set_warnings(${target} -Wconversion)
    set(PINTLE_PRECISIONS ${PINTLE_PRECISIONS} ${precision} PARENT_SCOPE)
    return()
  endif()
  # The exact solver is in double, and so packs what it can: a tenth of its step. It is compiled a few files at once, for Eigen's
  # headers take longest. (A precompiled header would bring its own options.)
  file(GLOB_RECURSE solver CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/plugin/pintle/solver/*.cpp")
  list(REMOVE_ITEM solver "${sequential}")
  add_library(${target}_solver OBJECT ${solver})
  target_compile_features(${target}_solver PUBLIC cxx_std_17)
  target_include_directories(${target}_solver PRIVATE "${PROJECT_SOURCE_DIR}/adapters" "${PROJECT_SOURCE_DIR}/plugin")
  target_link_libraries(${target}_solver PRIVATE PintleBullet::${precision} Eigen3::Eigen)
  pintle_compile_library(${target}_solver ${precision})
  target_compile_options(${target}_solver PRIVATE "$<$<CXX_COMPILER_ID:GNU>:-ftree-slp-vectorize>")
  set_target_properties(${target}_solver PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 9)
  pintle_set_warnings(${target}_solver -Wconversion)
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_solver>)
  pintle_set_warnings(${target} -Wconversion)
  if(PINTLE_TOP_LEVEL)  # who builds it with his own project does so once
    target_precompile_headers(${target} PRIVATE <Eigen/Geometry> <btBulletDynamicsCommon.h>)
  endif()
  set(PINTLE_PRECISIONS ${PINTLE_PRECISIONS} ${precision} PARENT_SCOPE)
endfunction()

# One export set a precision, so that a component can be had without the other's Bullet.
function(pintle_install)
  set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/pintle")
  foreach(precision IN LISTS PINTLE_PRECISIONS)
    install(TARGETS pintle_${precision} EXPORT pintle-${precision} ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
    install(EXPORT pintle-${precision} NAMESPACE pintle:: FILE pintle-targets-${precision}.cmake DESTINATION "${package_dir}")
  endforeach()
  # The public headers, and what pintle/extend.h needs: neither the solver's own, nor those of the joints' .cpp files.
  install(DIRECTORY adapters/pintle DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.h"
    PATTERN joint_rows.h EXCLUDE PATTERN row_writer.h EXCLUDE PATTERN solver_body.h EXCLUDE)
  install(DIRECTORY plugin/pintle DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.h"
    PATTERN solver EXCLUDE PATTERN record EXCLUDE PATTERN upgrade EXCLUDE
    PATTERN axis_part.h EXCLUDE PATTERN block.h EXCLUDE
    PATTERN drawing.h EXCLUDE PATTERN hinge_rows.h EXCLUDE PATTERN solver_rows.h EXCLUDE PATTERN single_row.h EXCLUDE
    PATTERN turning.h EXCLUDE PATTERN joints/constants.h EXCLUDE PATTERN euler_turn.h EXCLUDE PATTERN pose_drive_rows.h EXCLUDE
    PATTERN gear_row.h EXCLUDE PATTERN gear_side.h EXCLUDE
    PATTERN private_member.h EXCLUDE PATTERN complaints.h EXCLUDE PATTERN frames.h EXCLUDE PATTERN stock_ball.h EXCLUDE
    PATTERN stock_limits.h EXCLUDE PATTERN open_slider.h EXCLUDE)
  list(TRANSFORM PINTLE_SOLVER_HEADERS PREPEND "plugin/pintle/solver/" OUTPUT_VARIABLE solver)
  install(FILES ${solver} DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/pintle/solver")
  # Made with Node (demos/page): where there is none, a program names its own.
  install(FILES "${PROJECT_BINARY_DIR}/page/pintle_page.html" DESTINATION "${CMAKE_INSTALL_DATADIR}/pintle" OPTIONAL)
  set(version_file "${PROJECT_BINARY_DIR}/pintle-config-version.cmake")
  write_basic_package_version_file("${version_file}" COMPATIBILITY SameMinorVersion)
  install(FILES adapters/cmake/pintle-config.cmake adapters/cmake/FindPintleBullet.cmake "${version_file}"
          DESTINATION "${package_dir}")
endfunction()
