# A Slurm cluster of one machine with two slots, in $work, on ports of its own. Sourced by tests/farm/run.

cluster_pids=()

start_cluster() {
    local host etc=$work/cluster
    host=$(hostname -s)
    mkdir -p "$etc"/{state,spool}
    export SLURM_CONF=$etc/slurm.conf
    # Here and not with the test's own: each queue runs in a subshell, whose variables end with it.
    trap stop_cluster EXIT
    dd if=/dev/urandom of="$etc/munge.key" bs=1024 count=1 status=none
    chmod 600 "$etc/munge.key"
    # munged refuses directories that others may write, and there is no telling whose TMPDIR is.
    chmod 755 "$work" "$etc"
    munged --foreground --force --key-file="$etc/munge.key" --socket="$etc/munge.socket" \
        --pid-file="$etc/munge.pid" --log-file="$etc/munge.log" --seed-file="$etc/munge.seed" &
    cluster_pids+=($!)
    # Two slots whatever the machine has; no cgroups, which containers seldom may make.
    cat >"$SLURM_CONF" <<END
ClusterName=twintree
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$etc/munge.socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=2,sched_interval=2
ReturnToService=2
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
StateSaveLocation=$etc/state
SlurmdSpoolDir=$etc/spool
SlurmctldPort=26817
SlurmdPort=26818
SlurmctldPidFile=$etc/slurmctld.pid
SlurmdPidFile=$etc/slurmd.pid
SlurmctldLogFile=$etc/slurmctld.log
SlurmdLogFile=$etc/slurmd.log
SlurmdParameters=config_overrides
KillWait=5
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=farm Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
    wait_until 20 "munge" munge --socket="$etc/munge.socket" --no-input
    slurmctld -D -f "$SLURM_CONF" >"$etc/slurmctld.out" 2>&1 &
    cluster_pids+=($!)
    slurmd -D -f "$SLURM_CONF" >"$etc/slurmd.out" 2>&1 &
    cluster_pids+=($!)
    wait_until 60 "a node that is idle (see $etc/slurmd.log)" node_is_idle
}

node_is_idle() { [ "$(sinfo --noheader --format=%T)" = idle ]; }

# In the order of starting turned round; the daemons of this test and no other's.
stop_cluster() {
    local i
    for ((i = ${#cluster_pids[@]} - 1; i >= 0; i--)); do
        kill "${cluster_pids[i]}" 2>/dev/null || true
        wait "${cluster_pids[i]}" 2>/dev/null || true
    done
    cluster_pids=()
}
