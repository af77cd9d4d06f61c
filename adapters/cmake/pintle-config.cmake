# find_package(pintle [COMPONENTS single double] [extend]) -> pintle::single, pintle::double.
# Without components: each installed precision whose Bullet is there.
#
# If Eigen is found, also pintle::extend_single, pintle::extend_double: for joints of one's own (pintle/extend.h). The
# component extend says that they must be there; nothing else needs Eigen.

if(NOT TARGET Eigen3::Eigen)
  find_package(Eigen3 QUIET NO_MODULE)
endif()
list(INSERT CMAKE_MODULE_PATH 0 "${CMAKE_CURRENT_LIST_DIR}")
find_package(PintleBullet QUIET)
list(REMOVE_AT CMAKE_MODULE_PATH 0)

set(_pintle_components ${pintle_FIND_COMPONENTS})
list(REMOVE_ITEM _pintle_components extend)
if(NOT _pintle_components)
  set(_pintle_components single double)
endif()

set(pintle_FOUND FALSE)
set(pintle_NOT_FOUND_MESSAGE "")
set(_pintle_required_missing FALSE)
foreach(_pintle_component IN LISTS _pintle_components)
  set(pintle_${_pintle_component}_FOUND FALSE)
  set(_pintle_targets "${CMAKE_CURRENT_LIST_DIR}/pintle-targets-${_pintle_component}.cmake")
  if(NOT EXISTS "${_pintle_targets}")
    string(APPEND pintle_NOT_FOUND_MESSAGE "Pintle's component '${_pintle_component}' is not installed here. ")
  elseif(NOT PintleBullet_${_pintle_component}_FOUND)
    string(TOUPPER ${_pintle_component} _pintle_upper)
    string(APPEND pintle_NOT_FOUND_MESSAGE "Pintle's component '${_pintle_component}' needs Bullet in "
      "${_pintle_component} precision, which was not found (PINTLE_BULLET_${_pintle_upper}_ROOT can name where it is installed). ")
  else()
    include("${_pintle_targets}")
    if(TARGET Eigen3::Eigen AND NOT TARGET pintle::extend_${_pintle_component})
      add_library(pintle::extend_${_pintle_component} INTERFACE IMPORTED)
      set_target_properties(pintle::extend_${_pintle_component} PROPERTIES
        INTERFACE_LINK_LIBRARIES "pintle::${_pintle_component};Eigen3::Eigen")
    endif()
    set(pintle_${_pintle_component}_FOUND TRUE)
    set(pintle_FOUND TRUE)
  endif()
  if(pintle_FIND_REQUIRED_${_pintle_component} AND NOT pintle_${_pintle_component}_FOUND)
    set(_pintle_required_missing TRUE)
  endif()
endforeach()

if("extend" IN_LIST pintle_FIND_COMPONENTS)
  set(pintle_extend_FOUND FALSE)
  if(TARGET Eigen3::Eigen)
    set(pintle_extend_FOUND TRUE)
  else()
    string(APPEND pintle_NOT_FOUND_MESSAGE "Pintle's component 'extend' needs Eigen, which was not found (Eigen3_DIR). ")
    if(pintle_FIND_REQUIRED_extend)
      set(_pintle_required_missing TRUE)
    endif()
  endif()
endif()

if(_pintle_required_missing)
  set(pintle_FOUND FALSE)
endif()
