# A Slurm cluster of four virtual nodes on the loopback device, with all files in one folder; sourced by slurm-test.sh. Needs root.
# shellcheck shell=bash

cluster_nodes="n1 n2 n3 n4"

cluster_install() {
  local package missing=()
  for package in slurmctld slurmd slurm-client munge parallel util-linux mount; do
    dpkg-query -W -f='${db:Status-Status}' "$package" 2> /dev/null | grep -qx installed || missing+=("$package")
  done
  if [ ${#missing[@]} -eq 0 ]; then return; fi
  say "installing ${missing[*]}"
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -q > /dev/null
  apt-get install -q -y --no-install-recommends "${missing[@]}" > /dev/null
}

# cluster_start FOLDER
cluster_start() {
  cluster=$1
  local host node
  host=$(hostname -s)
  mkdir -p "$cluster/state" "$cluster/log"
  dd if=/dev/urandom of="$cluster/munge.key" bs=1024 count=1 status=none
  chmod 600 "$cluster/munge.key"
  /usr/sbin/munged --force --key-file="$cluster/munge.key" --socket="$cluster/munge.socket" --pid-file="$cluster/munged.pid" \
    --log-file="$cluster/log/munged.log" --seed-file="$cluster/munge.seed" 2> /dev/null
  cat > "$cluster/slurm.conf" << CONF
ClusterName=ngs
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$cluster/munge.socket
StateSaveLocation=$cluster/state
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmctldLogFile=$cluster/log/slurmctld.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=1,sched_interval=5,bf_interval=5
ReturnToService=2
SlurmdTimeout=10
KillWait=5
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SlurmdPidFile=$cluster/slurmd-%n.pid
SlurmdSpoolDir=$cluster/spool-%n
SlurmdLogFile=$cluster/log/slurmd-%n.log
SlurmdParameters=config_overrides
NodeName=n[1-4] NodeHostname=$host NodeAddr=127.0.0.1 Port=[17001-17004] CPUs=1 RealMemory=2000 State=UNKNOWN
PartitionName=main Nodes=n[1-4] Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$cluster/slurm.conf
  /usr/sbin/slurmctld
  for node in $cluster_nodes; do node_start "$node"; done
  for _ in $(seq 30); do
    if [ "$(sinfo -h -N -t idle 2> /dev/null | wc -l)" -eq 4 ]; then return; fi
    sleep 1
  done
  cat "$cluster"/log/slurmctld.log >&2
  fail 70 "the four nodes did not start"
}

node_start() { NGS_VIRTUAL_NODE=$cluster/$1 /usr/sbin/slurmd -N "$1"; }

# processes_with NAME=VALUE...: the ids of processes whose environment has all of these.
processes_with() {
  local folder setting
  for folder in /proc/[0-9]*; do
    for setting in "$@"; do
      grep -qzxF -- "$setting" "$folder/environ" 2> /dev/null || continue 2
    done
    printf '%s\n' "${folder#/proc/}"
  done
}

# slurmstepd does not inherit our environment; it is the parent of processes that do.
processes_of_node() {
  local pid parent
  processes_with "NGS_VIRTUAL_NODE=$cluster/$1"
  for pid in $(processes_with "SLURM_CONF=$cluster/slurm.conf" "SLURMD_NODENAME=$1"); do
    parent=$(awk '$1 == "PPid:" { print $2 }' "/proc/$pid/status" 2> /dev/null || true)
    if [ "$(cat "/proc/$parent/comm" 2> /dev/null)" = slurmstepd ]; then printf '%s\n' "$parent"; fi
    printf '%s\n' "$pid"
  done
}

# Ends a node as a power cut would: its daemon, its step managers and all their processes at once. SIGSTOP first, so that no
# process can report the end of another.
node_kill() {
  local pids
  mapfile -t pids < <(processes_of_node "$1" | sort -u)
  kill -STOP "${pids[@]}" 2> /dev/null || true
  kill -KILL "${pids[@]}" 2> /dev/null || true
}

cluster_stop() {
  local node pid
  [ -n "${cluster:-}" ] && [ -f "$cluster/slurm.conf" ] || return 0
  if [ -f "$cluster/slurmctld.pid" ]; then kill "$(cat "$cluster/slurmctld.pid")" 2> /dev/null || true; fi
  for node in $cluster_nodes; do node_kill "$node"; done
  if [ -f "$cluster/munged.pid" ]; then kill "$(cat "$cluster/munged.pid")" 2> /dev/null || true; fi
  for pid in slurmctld munged; do
    for _ in $(seq 50); do
      [ -f "$cluster/$pid.pid" ] && kill -0 "$(cat "$cluster/$pid.pid")" 2> /dev/null || break
      sleep 0.1
    done
  done
}
