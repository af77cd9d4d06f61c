# The library `headers`: each public header alone in a file, before and after fwd.h, and no Eigen in any.

get_target_property(include_dir pintle::${PRECISION} INTERFACE_INCLUDE_DIRECTORIES)
file(GLOB headers RELATIVE "${include_dir}" "${include_dir}/pintle/joints/*.h" "${include_dir}/pintle/joints/unstable/*.h"
  "${include_dir}/pintle/solver/*.h" "${include_dir}/pintle/pintle.h" "${include_dir}/pintle/fwd.h" "${include_dir}/pintle/record.h")
# With Eigen: it is for pintle/extend.h.
list(FILTER headers EXCLUDE REGEX "/observed_joint_rows.h$")
list(LENGTH headers count)
if(count LESS 20)
  message(FATAL_ERROR "found ${count} headers in ${include_dir}: this test sees nothing")
endif()

function(add_file name text)
  set(path "${CMAKE_CURRENT_BINARY_DIR}/headers/${name}.cpp")
  file(WRITE "${path}.new" "${text}
#ifdef EIGEN_WORLD_VERSION
#error A public header includes Eigen
#endif
")
  configure_file("${path}.new" "${path}" COPYONLY)  # keeps what has not changed
  set(files ${files} "${path}" PARENT_SCOPE)
endfunction()

file(READ "${include_dir}/pintle/fwd.h" fwd)
file(READ "${include_dir}/pintle/pintle.h" all)
set(includes "")
set(uses "")
set(files "")
foreach(header IN LISTS headers)
  string(MAKE_C_IDENTIFIER "${header}" name)
  add_file(${name} "#include <${header}>")
  if(NOT header MATCHES "pintle/(fwd|pintle).h")
    string(APPEND includes "#include <${header}>\n")
  endif()
  if(header MATCHES "^pintle/joints/[a-z_]+.h" AND NOT header MATCHES "(/joint|_base|_model|/frame_joint|/gear_coordinate|/driven_joint|/pose_drive|/posed_joint|/standalone_joint|/observed_joint|/hinge_of|/six_dof_of|/joint_of|/seen_poses|/bullet_rows).h" AND NOT all MATCHES "#include <${header}>")
    message(FATAL_ERROR "pintle/pintle.h does not include ${header}")
  endif()
  if(header MATCHES "(/observed_joint|/hinge_of|/six_dof_of|/joint_of|/joint_solver|/upgrading_solver).h")  # templates
    continue()
  endif()
  file(STRINGS "${include_dir}/${header}" classes REGEX "^class [A-Za-z0-9]+ (final )?: public ")
  foreach(class IN LISTS classes)
    string(REGEX REPLACE "^class ([A-Za-z0-9]+).*" "\\1" class "${class}")
    if(NOT fwd MATCHES "class ${class};")
      message(FATAL_ERROR "pintle/fwd.h does not name ${class}")
    endif()
    string(APPEND uses "static pintle::${class}* ${class}_pointer;\nvoid* use_${class}() { return ${class}_pointer; }\n")
  endforeach()
endforeach()
add_file(fwd_first "#include <pintle/fwd.h>\nnamespace first {\n${uses}}\n${includes}")
add_file(fwd_last "${includes}#include <pintle/fwd.h>\nnamespace last {\n${uses}}")

add_library(headers STATIC ${files})
set_target_properties(headers PROPERTIES UNITY_BUILD OFF)
target_link_libraries(headers PRIVATE pintle::${PRECISION})
if(NOT MSVC)
  target_compile_options(headers PRIVATE -Wall -Wextra -Werror)
endif()
