# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# A Slurm cluster on this machine: munge, slurmctld, and a slurmd for each node. Everything is in $work. Sourced by run.
#
#   startCluster NODE…    exports SLURM_CONF, for sbatch and squeue
#   killNode NODE         kills the node's slurmd and everything that it started, as a power failure does
#   stopCluster

: "${work:?}"

require() {
  local program
  for program in "$@"; do
    if ! command -v "$program" > /dev/null; then
      echo "skipped: $program is missing; 'scripts/setup.sh farm' installs it"
      exit 77
    fi
  done
}

daemons=()
declare -A slurmds=()

startCluster() {
  require munged slurmctld slurmd sbatch squeue scontrol
  local name user port node
  name=$(hostname)
  user=$(id -un)
  mkdir -p "$work/munge" "$work/slurm/state" "$work/slurm/log"
  chmod 700 "$work/munge"
  (umask 077 && head -c 1024 /dev/urandom > "$work/munge/key")
  munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" \
    --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" > /dev/null 2>&1 &
  daemons+=($!)
  port=$((20000 + RANDOM % 20000))
  {
    cat << CONFIG
ClusterName=quintet
SlurmctldHost=$name(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
MailProg=/bin/true
StateSaveLocation=$work/slurm/state
SlurmctldPidFile=$work/slurm/slurmctld.pid
SlurmdPidFile=$work/slurm/slurmd-%n.pid
SlurmdSpoolDir=$work/slurm/spool-%n
SlurmctldLogFile=$work/slurm/log/slurmctld
SlurmdLogFile=$work/slurm/log/slurmd-%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SlurmdTimeout=10
MessageTimeout=10
KillWait=2
SchedulerParameters=sched_min_interval=200000,sched_interval=1,batch_sched_delay=1
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONFIG
    for node in "$@"; do
      echo "NodeName=$node NodeHostname=$name NodeAddr=127.0.0.1 Port=$((++port)) CPUs=1 State=UNKNOWN"
    done
  } > "$work/slurm/slurm.conf"
  export SLURM_CONF=$work/slurm/slurm.conf
  setsid slurmctld -D -f "$SLURM_CONF" > "$work/slurm/log/slurmctld.out" 2>&1 &
  daemons+=($!)
  for node in "$@"; do
    setsid slurmd -D -N "$node" -f "$SLURM_CONF" > "$work/slurm/log/slurmd-$node.out" 2>&1 &
    slurmds[$node]=$!
  done
  waitFor 60 "the nodes" nodesAreIdle "$#"
}

nodesAreIdle() { [[ $(sinfo --noheader --Node --states=idle --format=%N 2> /dev/null | sort -u | wc -l) == "$1" ]]; }

# waitFor SECONDS WHAT COMMAND…
waitFor() {
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@"; do
    if ((SECONDS > deadline)); then
      echo "waited too long for $what" >&2
      return 1
    fi
    sleep 0.2
  done
}

# The processes of a node: its slurmd, those whose environment has its name (the job), and the slurmstepd above them.
nodeProcesses() {
  local process parent
  echo "${slurmds[$1]}"
  for process in /proc/[0-9]*; do
    if tr '\0' '\n' 2> /dev/null < "$process/environ" | grep -qx "SLURMD_NODENAME=$1" \
      && tr '\0' '\n' 2> /dev/null < "$process/environ" | grep -qx "SLURM_CONF=$SLURM_CONF"; then
      echo "${process#/proc/}"
      parent=$(ps -o ppid= -p "${process#/proc/}" | tr -d ' ')
      if [[ $(ps -o comm= -p "$parent") == slurmstepd ]]; then echo "$parent"; fi
    fi
  done
}

killNode() {
  local processes
  mapfile -t processes < <(nodeProcesses "$1" | sort -u)
  # All at the same time: slurmstepd must not report the end of its job.
  kill -STOP "${processes[@]}" 2> /dev/null || true
  kill -9 "${processes[@]}" 2> /dev/null || true
  wait "${slurmds[$1]}" 2> /dev/null || true
  unset "slurmds[$1]"
}

stopCluster() {
  local node
  if [[ -n ${SLURM_CONF-} ]]; then scancel --user="$(id -un)" 2> /dev/null || true; fi
  for node in "${!slurmds[@]}"; do killNode "$node"; done
  if ((${#daemons[@]} > 0)); then kill -9 "${daemons[@]}" 2> /dev/null || true; wait "${daemons[@]}" 2> /dev/null || true; fi
  daemons=()
}
