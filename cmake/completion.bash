# Bash completion for rodsweep: commands and options as in --help, job files, results files.
_rodsweep() {
  local program=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} files='!*.h5'
  if [ "$COMP_CWORD" = 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$program" --help | sed -n 's/^  \([a-z]\+\) \+[A-Z].*/\1/p') --help --version" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$program" "${COMP_WORDS[1]}" --help | grep -oE -- '^  [^ ].*' | grep -oE -- '--[a-z-]+')" -- "$word")
  else
    case ${COMP_WORDS[1]} in run | plan | validate) files='!*.json' ;; esac
    case ${COMP_WORDS[COMP_CWORD - 1]} in -o | --output | --extend) files='!*.h5' ;; esac
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -X "$files" -- "$word"; compgen -d -- "$word")
  fi
}
complete -F _rodsweep rodsweep
