# Completion for bash: commands, scenarios, cases and keys, as the programs themselves list them.
# In a terminal: source scripts/completion.bash. The packages install it.

# _breakwater_words COMMAND...: what a program lists, first words; nothing if it fails.
_breakwater_words() {
  "$@" 2>/dev/null | sed -n 's/^ *\([A-Za-z0-9._+-]\{1,\}\).*/\1/p'
}

# The options that a help text names.
_breakwater_options() {
  "$@" --help 2>/dev/null | sed -n 's/^  \(-h,\)\{0,1\}\(--[a-z-]\{1,\}\).*/\2/p'
}

# _breakwater_keys SCENARIO...: KEY= of each key of the effective configuration.
_breakwater_keys() {
  "$@" --print-config 2>/dev/null | awk '
    /^\[case\./ { exit }
    /^\[/ { gsub(/[][]/, ""); table = $0 "."; next }
    /^[A-Za-z_]+ = / { if ($1 != "scenario" && $1 != "default_case") print table $1 "=" }'
}

# Of a run: SCENARIO... is the command that runs it without options.
_breakwater_run() {
  local before=$1 current=$2
  shift 2
  case $before in
    --case) COMPREPLY=($(compgen -W "$(_breakwater_words "$@" --list-cases) all" -- "$current")) ;;
    --set)
      COMPREPLY=($(compgen -W "$(_breakwater_keys "$@")" -- "$current"))
      [ ${#COMPREPLY[@]} -ne 1 ] || compopt -o nospace
      ;;
    --config) COMPREPLY=($(compgen -f -X '!*.toml' -- "$current")) ;;
    --out | --video) COMPREPLY=($(compgen -f -- "$current")) ;;
    *) COMPREPLY=($(compgen -W "$(_breakwater_options "$@")" -- "$current")) ;;
  esac
}

_breakwater() {
  local program=${COMP_WORDS[0]} current=${COMP_WORDS[COMP_CWORD]}
  local before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]} word i
  COMPREPLY=()
  # The keys of --set go on until the next option.
  for ((i = COMP_CWORD - 1; i > 0; i--)); do
    word=${COMP_WORDS[i]}
    [[ $word != --* ]] || { [ "$word" != --set ] || before=--set; break; }
  done
  if [ "$("$program" --help 2>/dev/null | grep -c '^Usage:.*SUBCOMMAND')" -eq 0 ]; then
    _breakwater_run "$before" "$current" "$program"  # a scenario's own binary
  elif [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "$("$program" --help | sed -n 's/^  \([a-z]\{1,\}\) .*/\1/p')" -- "$current"))
  elif [ "$command" = run ] && [ "$COMP_CWORD" -eq 2 ]; then
    COMPREPLY=($(compgen -W "$(_breakwater_words "$program" list)" -- "$current"))
  elif [ "$command" = sweep ] && [ "$COMP_CWORD" -eq 2 ]; then
    COMPREPLY=($(compgen -W "$(_breakwater_words "$program" list)" -- "$current") $(compgen -f -- "$current"))
  elif [ "$command" = sweep ] && [ "$before" = --vary -o "$before" = --set -o "$before" = --case ]; then
    [ "$before" != --vary ] || before=--set
    _breakwater_run "$before" "$current" "$program" run "${COMP_WORDS[2]}"
  elif [ "$command" = run ]; then
    _breakwater_run "$before" "$current" "$program" run "${COMP_WORDS[2]}"
  elif [[ $current == -* ]]; then
    COMPREPLY=($(compgen -W "$(_breakwater_options "$program" "$command")" -- "$current"))
  else
    COMPREPLY=($(compgen -f -- "$current"))
  fi
}

complete -F _breakwater -o filenames breakwater
