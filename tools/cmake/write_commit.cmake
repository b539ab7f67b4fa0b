# Writes a header with the commit that a source tree is at, and whether its files differ from it; only when
# it changes, so that nothing is compiled again for the same commit. Without git, or when the tree is
# not the top of a repository (an archive, perhaps inside another repository), the commit is "unknown".
# Usage: cmake -DSOURCE=… -DHEADER=… -P write_commit.cmake
cmake_minimum_required(VERSION 3.25)

set(commit "")
set(modified false)
find_program(GIT git)
if(GIT)
  # No locks: another git may be at work in the same tree.
  set(git "${GIT}" --no-optional-locks -C "${SOURCE}")
  execute_process(COMMAND ${git} rev-parse --show-prefix --short=12 HEAD
                  OUTPUT_VARIABLE lines ERROR_QUIET RESULT_VARIABLE status)
  # The prefix is the way from the top of the repository to SOURCE: an empty line at its top.
  if(status EQUAL 0 AND lines MATCHES "^\n([0-9a-f]+)\n$")
    set(commit "${CMAKE_MATCH_1}")
    execute_process(COMMAND ${git} status --porcelain OUTPUT_VARIABLE changes ERROR_QUIET)
    if(NOT changes STREQUAL "")
      set(modified true)
    endif()
  endif()
endif()
if(commit STREQUAL "")
  set(commit unknown)
endif()

set(text "// Written by tools/cmake/write_commit.cmake.
#pragma once

#define MBD_COMMIT \"${commit}\"
#define MBD_COMMIT_MODIFIED ${modified}
")
set(before "")
if(EXISTS "${HEADER}")
  file(READ "${HEADER}" before)
endif()
if(NOT text STREQUAL before)
  file(WRITE "${HEADER}" "${text}")
endif()
