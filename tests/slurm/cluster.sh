# A Slurm cluster of two hosts for a test, sourced by night.sh: a controller here, and two hosts that are
# namespaces of their own (network, name, processes) on a bridge. Everything is inside the namespaces that
# night.sh was started in and ends with them; nothing of the machine's own Slurm or network is touched.
#   start_cluster DIR    state, logs and slurm.conf in DIR; exports SLURM_CONF; returns when both hosts are idle
#   power_cut NAME       the host and all that runs on it are gone at once
cluster_conf() {
  cat <<CONF
ClusterName=hybrid
SlurmctldHost=$(hostname)(10.213.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$1/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation=$1/state
SlurmdSpoolDir=$1/spool-%n
SlurmctldPidFile=$1/slurmctld.pid
SlurmdPidFile=$1/slurmd-%n.pid
SlurmctldLogFile=$1/slurmctld.log
SlurmdLogFile=$1/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=2,bf_interval=2
MpiDefault=none
ReturnToService=2
SlurmdTimeout=5
KillWait=2
MinJobAge=300
MaxArraySize=4
NodeName=n1 NodeHostname=n1 NodeAddr=10.213.0.11 CPUs=1 RealMemory=1000 State=UNKNOWN
NodeName=n2 NodeHostname=n2 NodeAddr=10.213.0.12 CPUs=1 RealMemory=1000 State=UNKNOWN
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
}

# The host waits for its end of the cable, then becomes slurmd. --kill-child: who kills the outer process
# ends everything in the namespace.
start_host() {
  local dir=$1 name=$2 address=$3
  unshare --net --uts --pid --fork --kill-child=KILL --mount-proc sh -c "
    hostname $name
    until ip link show eth0 >/dev/null 2>&1; do sleep 0.05; done
    ip link set lo up; ip addr add $address/24 dev eth0; ip link set eth0 up
    mkdir -p $dir/spool-$name
    exec slurmd -D -f $dir/slurm.conf -N $name" >"$dir/host-$name.log" 2>&1 &
  local outer=$!
  echo "$outer" >"$dir/$name.pid"
  local inner
  until inner=$(pgrep -P "$outer" -x sh || pgrep -P "$outer" -x slurmd); do sleep 0.05; done
  ip link add "to-$name" type veth peer name eth0 netns "$inner"
  ip link set "to-$name" master bridge0 up
}

start_cluster() {
  local dir=$1
  mkdir -p "$dir/state" && chmod 700 "$dir"
  export SLURM_CONF=$dir/slurm.conf
  cluster_conf "$dir" >"$SLURM_CONF"
  ip link set lo up
  ip link add bridge0 type bridge && ip addr add 10.213.0.1/24 dev bridge0 && ip link set bridge0 up
  head -c 1024 /dev/urandom >"$dir/munge.key" && chmod 400 "$dir/munge.key"
  munged --force --key-file="$dir/munge.key" --socket="$dir/munge.socket" --pid-file="$dir/munged.pid" \
    --log-file="$dir/munged.log" --seed-file="$dir/munged.seed" 2>>"$dir/munged.log" || return 1
  slurmctld -f "$SLURM_CONF" || return 1
  start_host "$dir" n1 10.213.0.11
  start_host "$dir" n2 10.213.0.12
  for _ in $(seq 200); do
    [ "$(sinfo -h -N -o '%T' 2>/dev/null | grep -c idle)" = 2 ] && return 0
    sleep 0.1
  done
  sinfo -N >&2
  tail -n 5 "$dir"/slurmctld.log "$dir"/slurmd-*.log "$dir"/host-*.log >&2
  return 1
}

power_cut() {
  kill -KILL "$(cat "$1/$2.pid")"
}
