# The target `docs`: a site of the pages and of the public headers, if Doxygen is installed. Headers that are for joints of one's
# own alone (pintle/extend.h) are not in it.

find_package(Doxygen QUIET)
find_program(PINTLE_AWK awk)
find_program(PINTLE_SED sed)
mark_as_advanced(PINTLE_AWK PINTLE_SED)
if(NOT DOXYGEN_FOUND OR NOT PINTLE_AWK OR NOT PINTLE_SED)
  return()
endif()

set(pintle_site "${PROJECT_SOURCE_DIR}/plugin/docs/site")
set(DOXYGEN_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/site")
set(DOXYGEN_PROJECT_NAME "Pintle")
set(DOXYGEN_EXCLUDE_SYMBOLS "pintle::equations" "pintle::equations::*")
set(DOXYGEN_PROJECT_BRIEF "Joints for the Bullet physics engine")
set(DOXYGEN_RECURSIVE YES)
set(DOXYGEN_FILE_PATTERNS "*.h" "*.md")
# What is installed for the headers that are public, and nobody includes by himself.
set(DOXYGEN_EXCLUDE_PATTERNS "*/joint_passes.h" "*/hinge_rows.h" "*/drawing.h" "*/turning.h" "*/euler_turn.h" "*/pose_drive_rows.h" "*/gear_row.h" "*/gear_side.h" "*/single_row.h" "*/observed_joint_rows.h")
set(DOXYGEN_FILTER_PATTERNS "\"*.h=${PINTLE_SED} -f ${pintle_site}/headers.sed\"" "\"*.md=${PINTLE_AWK} -f ${pintle_site}/pages.awk\"")
set(DOXYGEN_VERBATIM_VARS DOXYGEN_FILTER_PATTERNS)
set(DOXYGEN_FILTER_SOURCE_FILES NO)
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE "${PROJECT_SOURCE_DIR}/README.md")
set(DOXYGEN_IMAGE_PATH "${PROJECT_SOURCE_DIR}/plugin/docs/drawings" "${PROJECT_SOURCE_DIR}/plugin/docs/pictures" "${PROJECT_SOURCE_DIR}/demos/results")
set(DOXYGEN_STRIP_FROM_PATH "${PROJECT_SOURCE_DIR}/plugin" "${PROJECT_SOURCE_DIR}")
set(DOXYGEN_STRIP_FROM_INC_PATH "${PROJECT_SOURCE_DIR}/plugin")
set(DOXYGEN_MACRO_EXPANSION YES)
set(DOXYGEN_EXPAND_ONLY_PREDEF YES)
set(DOXYGEN_PREDEFINED "BT_DECLARE_ALIGNED_ALLOCATOR()=" "PINTLE_FLATTEN=")
set(DOXYGEN_DISTRIBUTE_GROUP_DOC YES)
set(DOXYGEN_SORT_MEMBER_DOCS NO)
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
set(DOXYGEN_HIDE_UNDOC_RELATIONS NO)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_GENERATE_LATEX NO)
set(DOXYGEN_GENERATE_TREEVIEW YES)
set(DOXYGEN_HTML_EXTRA_STYLESHEET "${pintle_site}/site.css")
set(DOXYGEN_QUIET YES)
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
list(TRANSFORM PINTLE_SOLVER_HEADERS PREPEND "${PROJECT_SOURCE_DIR}/plugin/pintle/solver/" OUTPUT_VARIABLE pintle_solver_headers)
doxygen_add_docs(docs
  "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${PROJECT_SOURCE_DIR}/plugin/docs"
  "${PROJECT_SOURCE_DIR}/plugin/pintle/pintle.h" "${PROJECT_SOURCE_DIR}/plugin/pintle/fwd.h" "${PROJECT_SOURCE_DIR}/plugin/pintle/record.h"
  "${PROJECT_SOURCE_DIR}/plugin/pintle/joints" ${pintle_solver_headers}
  COMMENT "Documentation: ${PROJECT_BINARY_DIR}/site/html/index.html")
