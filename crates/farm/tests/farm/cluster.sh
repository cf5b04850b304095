#!/usr/bin/env bash
# A Slurm cluster for tests: all of its nodes are on this machine, and all it writes is in one folder.
#   cluster.sh start FOLDER NODES      exit status 77 where it cannot be done, with the reason
#   cluster.sh stop FOLDER
set -euo pipefail
folder=${2:?a folder}

# Whether a process runs: it is there, and not only until somebody asks how it ended.
runs() {
  local state
  state=$(ps -o stat= -p "$1" 2>/dev/null) && [ "${state#Z}" = "$state" ]
}

if [ "${1:-}" = stop ]; then
  export SLURM_CONF=$folder/slurm.conf
  scancel --quiet --state=RUNNING,PENDING 2>/dev/null || true
  for file in "$folder"/run/*.pid; do
    [ -s "$file" ] || continue
    kill "$(cat "$file")" 2>/dev/null || true
  done
  # What stands for a job goes on telling a controller that is no longer there.
  for process in /proc/[0-9]*; do
    if grep -qsz "^slurmstepd" "$process/cmdline" && grep -qsz "^SLURM_CONF=$SLURM_CONF\$" "$process/environ"; then
      kill -KILL "${process#/proc/}" 2>/dev/null || true
    fi
  done
  # Daemons write until they have ended.
  for file in "$folder"/run/*.pid; do
    [ -s "$file" ] || continue
    # The file may go with its daemon.
    while number=$(cat "$file" 2>/dev/null) && runs "$number"; do :; done
  done
  exit 0
fi

nodes=${3:?a number of nodes}
export PATH=$PATH:/usr/sbin:/sbin
for program in munged slurmctld slurmd sbatch squeue; do
  if ! command -v "$program" >/dev/null; then
    echo "$program is not installed" >&2
    exit 77
  fi
done
user=$(id -un)
host=$(hostname -s)
# Some twenty ports that hardly anybody else has.
port=$((20000 + $$ % 2000 * 20))
mkdir -p "$folder"/{run,log,state,key}
chmod 755 "$folder" "$folder/run"
chmod 700 "$folder/key"
(umask 077 && head -c 1024 /dev/urandom >"$folder/key/munge.key")
munged --force --num-threads=1 --key-file="$folder/key/munge.key" --socket="$folder/run/munge.socket" \
  --pid-file="$folder/run/munged.pid" --log-file="$folder/log/munged.log" --seed-file="$folder/key/seed"

{
  cat <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/run/munge.socket,cred_expire=5
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool.%n
SlurmctldPidFile=$folder/run/slurmctld.pid
SlurmdPidFile=$folder/run/slurmd.%n.pid
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
SlurmdParameters=config_overrides
ReturnToService=2
JobRequeue=1
SlurmdTimeout=5
KillWait=1
InactiveLimit=0
CONF
  for ((node = 0; node < nodes; node++)); do
    mkdir -p "$folder/spool.n$node"
    echo "NodeName=n$node NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1 + node)) CPUs=1 RealMemory=500"
  done
  echo "PartitionName=test Nodes=n[0-$((nodes - 1))] Default=YES MaxTime=INFINITE State=UP"
} >"$folder/slurm.conf"

export SLURM_CONF=$folder/slurm.conf
slurmctld -c
for ((node = 0; node < nodes; node++)); do
  slurmd -N "n$node"
done
for ((look = 0; look < 2000; look++)); do
  if [ "$(sinfo --noheader --Node --format=%t 2>/dev/null | grep -c '^idle')" = "$nodes" ]; then
    exit 0
  fi
done
echo "the nodes did not come up" >&2
tail -n 5 "$folder"/log/*.log >&2
bash "$0" stop "$folder"
exit 1
