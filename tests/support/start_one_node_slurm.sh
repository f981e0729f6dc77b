#!/usr/bin/env bash
# Starts a real Slurm of one node for tests of job arrays: munged, slurmctld and slurmd, without
# control groups and service manager, everything in one folder and on two ports. Debian 12 or 13,
# as root.
#   start_one_node_slurm.sh DIR FIRST_PORT [PROCESSORS]    prints SLURM_CONF
# To stop it: kill $(cat DIR/*.pid)
set -euo pipefail
folder=$(realpath -m "$1")
port=$2
processors=${3:-$(nproc)}

missing=()
for package in munge slurm-client slurmctld slurmd; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
    apt-get update -qq
    # Services stay off: the test starts its own.
    RUNLEVEL=1 DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

mkdir -p "$folder"/{state,spool,key}
chmod 700 "$folder/key"
(umask 077 && head -c 1024 /dev/urandom >"$folder/key/munge.key")
# Jobs that were requeued begin once their credentials have expired, after 120 s by default.
cat >"$folder/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=5
CryptoType=crypto/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,bf_interval=1
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
KillWait=5
SlurmctldPort=$port
SlurmdPort=$((port + 1))
NodeName=$(hostname) NodeAddr=127.0.0.1 CPUs=$processors State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
# Debian 13's fails without control groups unless told so; Debian 12's does not know the word.
[[ $(slurmd -V) == *" 22."* ]] || echo "CgroupPlugin=disabled" >"$folder/cgroup.conf"
export SLURM_CONF=$folder/slurm.conf
munged --key-file="$folder/key/munge.key" --socket="$folder/munge.socket" \
    --pid-file="$folder/munge.pid" --log-file="$folder/munge.log" \
    --seed-file="$folder/munge.seed" --force 2>/dev/null
slurmctld -i >/dev/null
slurmd >/dev/null
for _ in $(seq 60); do
    if sinfo --noheader --format %T 2>/dev/null | grep -q idle; then
        echo "$SLURM_CONF"
        exit 0
    fi
    sleep 0.25
done
echo "Slurm does not become idle; its logs are in $folder" >&2
exit 1
