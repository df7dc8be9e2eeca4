# Writes OUTPUT, a header with the git revision of SOURCE_DIR: "0123456789ab", with "-dirty" if tracked files differ, or
# "unknown" without git or outside its own clone. Runs in every build; the file changes only if the revision does.
set(REVISION "unknown")
find_program(GIT git)
if(GIT)
  # Building already runs code of this folder, so asking git is as safe, even if another user owns the clone.
  set(git ${GIT} -c safe.directory=* --no-optional-locks -C ${SOURCE_DIR})
  execute_process(COMMAND ${git} rev-parse --show-toplevel OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH ${SOURCE_DIR} here)
  if(top STREQUAL here)  # not the revision of an enclosing repository
    execute_process(COMMAND ${git} describe --always --exclude=* --abbrev=12 --dirty RESULT_VARIABLE failed
                    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(NOT failed)
      set(REVISION ${described})
    endif()
  endif()
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/revision.hpp.in ${OUTPUT} @ONLY)  # does not touch an unchanged file
