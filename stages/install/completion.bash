# Completion of bash for the command eyewright: options, folders, then stages.
_eyewright() {
	local word=${COMP_WORDS[COMP_CWORD]} lib i n=0 first=
	lib=$(readlink -f "$(command -v eyewright)") && lib=${lib%/*/*}/lib/eyewright
	for ((i = 1; i < COMP_CWORD; i++)); do
		case ${COMP_WORDS[i]} in -*) ;; *) n=$((n + 1)) && first=${first:-${COMP_WORDS[i]}} ;; esac
	done
	case $word in -*) mapfile -t COMPREPLY < <(compgen -W '--help --version --threads= --work= --jobs= --scheduler=slurm' -- "$word"); return ;; esac
	if [ "$n" = 0 ] || { [ "$n" = 1 ] && [[ $first = batch* ]]; }; then
		compopt -o filenames
		mapfile -t COMPREPLY < <(compgen -d -- "$word")
		[ "$n" != 0 ] || mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -W 'batch batch-status' -- "$word")
	elif [[ $first != batch* ]]; then
		mapfile -t COMPREPLY < <(compgen -W "$(ls -I version -I summary "$lib/bin" 2>/dev/null) clean" -- "$word")
	fi
}
complete -F _eyewright eyewright
