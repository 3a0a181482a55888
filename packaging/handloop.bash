# handloop completion for bash. Put this into ~/.bashrc:  eval "$(handloop completion bash)"
_handloop() {
  local current=${COMP_WORDS[COMP_CWORD]}
  local answers
  answers=$("${COMP_WORDS[0]}" complete-words "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  COMPREPLY=($(compgen -W "$answers" -- "$current"))
  if [ ${#COMPREPLY[@]} -eq 0 ] && [[ $current != -* ]]; then
    compopt -o filenames 2>/dev/null
    COMPREPLY=($(compgen -f -- "$current"))
  fi
}
complete -F _handloop handloop
