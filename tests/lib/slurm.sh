# A cluster of Slurm's for a test, sourced: slurmctld, munged and two emulated nodes n1 and n2 in $cluster, on this machine's loopback
# alone. A task of a dead node is queued again once its credential has expired, 15 s here. Each node is a process namespace of its own, so that it dies as a machine does, with all that it runs.
#   slurm_start     false where it does not come up
#   slurm_kill n2   that node's power is cut
#   slurm_stop      nothing is left running
cluster=$root/cluster

slurm_conf() {
	local user port=$((20000 + RANDOM % 20000))
	user=$(id -un)
	cat >"$cluster/slurm.conf" <<-EOF
		ClusterName=test
		SlurmctldHost=$(hostname -s)(127.0.0.1)
		SlurmUser=$user
		SlurmdUser=$user
		AuthType=auth/munge
		AuthInfo=socket=$cluster/munge.socket,cred_expire=15
		SlurmctldPort=$port
		CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
		StateSaveLocation=$cluster/state
		SlurmdSpoolDir=$cluster/spool.%n
		SlurmctldPidFile=$cluster/slurmctld.pid
		SlurmdPidFile=$cluster/slurmd.%n.pid
		SlurmctldLogFile=$cluster/slurmctld.log
		SlurmdLogFile=$cluster/slurmd.%n.log
		ProctrackType=proctrack/linuxproc
		TaskPlugin=task/none
		JobAcctGatherType=jobacct_gather/none
		AccountingStorageType=accounting_storage/none
		SelectType=select/cons_tres
		SelectTypeParameters=CR_Core_Memory
		SlurmdTimeout=5
		SlurmctldTimeout=5
		KillWait=1
		MinJobAge=300
		ReturnToService=2
		MpiDefault=none
		MessageTimeout=20
		NodeName=n1 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=4000
		NodeName=n2 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=4000
		PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
	EOF
}

slurm_start() {
	mkdir -p "$cluster"/{state,spool.n1,spool.n2} && chmod 755 "$root" "$cluster"
	export SLURM_CONF=$cluster/slurm.conf
	slurm_conf
	dd if=/dev/urandom of="$cluster/munge.key" bs=1024 count=1 2>/dev/null && chmod 600 "$cluster/munge.key"
	munged --force --key-file="$cluster/munge.key" --socket="$cluster/munge.socket" --pid-file="$cluster/munged.pid" \
		--log-file="$cluster/munged.log" --seed-file="$cluster/munge.seed" --num-threads=2 >"$cluster/munged.out" 2>&1 || return 1
	slurmctld -c -f "$SLURM_CONF" >"$cluster/slurmctld.out" 2>&1 || return 1
	local node
	for node in n1 n2; do
		unshare --pid --fork --kill-child=KILL --mount-proc slurmd -D -N "$node" -f "$SLURM_CONF" >"$cluster/$node.out" 2>&1 &
		printf '%s' "$!" >"$cluster/$node.pid"
	done
	for _ in $(seq 100); do
		[ "$(sinfo -h -N -o %t 2>/dev/null | grep -c idle)" = 2 ] && return 0
		sleep 0.1
	done
	return 1
}

slurm_kill() { { kill -9 "$(cat "$cluster/$1.pid")" && wait "$(cat "$cluster/$1.pid")"; } 2>/dev/null; }

slurm_stop() {
	slurm_kill n1
	slurm_kill n2
	local of pid
	for of in slurmctld munged; do
		pid=$(cat "$cluster/$of.pid" 2>/dev/null) && kill "$pid" 2>/dev/null && tail --pid="$pid" -f /dev/null
	done
}
