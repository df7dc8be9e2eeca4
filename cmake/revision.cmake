# Writes OUTPUT, a header with the revision of SOURCE_DIR as git knows it: "0123456789ab", "-dirty" after it when tracked
# files differ, "unknown" without git or outside a clone of our own. Run at every build; the file changes with the revision only.
set(REVISION "unknown")
find_program(GIT git)
if(GIT)
  # Whoever builds here already runs this folder's code, so a clone that belongs to another user is as safe to ask.
  set(git ${GIT} -c safe.directory=* --no-optional-locks -C ${SOURCE_DIR})
  execute_process(COMMAND ${git} rev-parse --show-toplevel OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH ${SOURCE_DIR} here)
  if(top STREQUAL here)  # not the revision of a repository that we were unpacked in
    execute_process(COMMAND ${git} describe --always --exclude=* --abbrev=12 --dirty RESULT_VARIABLE failed
                    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(NOT failed)
      set(REVISION ${described})
    endif()
  endif()
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/revision.hpp.in ${OUTPUT} @ONLY)  # leaves an unchanged file alone
