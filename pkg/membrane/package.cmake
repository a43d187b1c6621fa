# SPDX-License-Identifier: GPL-2.0-or-later
# What is installed, and as which Debian package, included by plugin.cmake. The plugin lies where every `yade` run finds
# it, if the prefix is /usr/local (the default) or /usr.

set(package_dir lib/python${python_version}/dist-packages/membrane)
install(TARGETS _membrane LIBRARY DESTINATION ${package_dir})
install(FILES ${releases} DESTINATION ${package_dir})
install(DIRECTORY scripts/membrane/ DESTINATION ${package_dir} FILES_MATCHING PATTERN *.py PATTERN Snakefile
        PATTERN __pycache__ EXCLUDE PATTERN viewer EXCLUDE)
# The viewer of report.html, if `scripts/run.sh viewer` has made it.
install(FILES ${python_dir}/membrane/view/viewer.html DESTINATION ${package_dir}/view OPTIONAL)

# The commands, as `yade-membrane deploy`.
set(share_dir share/yade-membrane)
install(DIRECTORY scripts/ DESTINATION ${share_dir}/scripts FILES_MATCHING PATTERN *.py PATTERN *.fold
        PATTERN membrane EXCLUDE PATTERN __pycache__ EXCLUDE
        REGEX "/(bench|chart|parts|probe|stability|verify)\\.py$" EXCLUDE
        REGEX "/(packaging|probing)$" EXCLUDE)
install(PROGRAMS scripts/run.sh DESTINATION ${share_dir}/scripts)
file(CREATE_LINK ../${share_dir}/scripts/run.sh ${PROJECT_BINARY_DIR}/yade-membrane SYMBOLIC)
install(FILES ${PROJECT_BINARY_DIR}/yade-membrane DESTINATION bin)

set(doc_dir share/doc/yade-membrane)
install(FILES README.md DESTINATION ${doc_dir})
install(FILES LICENSE DESTINATION ${doc_dir} RENAME copyright)
install(DIRECTORY reference/ DESTINATION ${doc_dir}/reference FILES_MATCHING PATTERN *.md PATTERN *.png PATTERN *.svg
        PATTERN __pycache__ EXCLUDE)

# `scripts/run.sh package` adds what it depends on.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME yade-membrane)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION}+yade${MEMBRANE_YADE})
set(CPACK_PACKAGE_CONTACT "The authors of yade-membrane <root@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Folded membranes that spin and deploy, for YADE ${MEMBRANE_YADE}")
set(CPACK_PACKAGE_DESCRIPTION "Solar sails and other folded membranes unfold by spinning: import membrane in a script
of YADE's, or the command yade-membrane.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/scripts/packaging/postinst
                                       ${PROJECT_SOURCE_DIR}/scripts/packaging/prerm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
