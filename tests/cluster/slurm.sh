#!/usr/bin/env bash
# A Slurm cluster on this machine, for tests: a controller and two node daemons, `n1` and `n2`, each of one core, with a key
# and sockets of their own in a folder.
#
#   slurm.sh up DIR      starts the cluster, as root. /etc/slurm/slurm.conf becomes a link to `DIR/slurm.conf`, since jobs of
#                        Snakemake have no SLURM_CONF; a machine that has a configuration of its own is left alone
#   slurm.sh node DIR N  starts the daemon of node N again
#   slurm.sh down DIR    stops all that `up` and `node` started
set -euo pipefail

# Ports of this cluster alone: tests may run at the same time.
base_port() {
    local free
    free=$(python3 -c 'import socket
taken = [socket.socket() for _ in range(4)]
[one.bind(("127.0.0.1", 0)) for one in taken]
print(*[one.getsockname()[1] for one in taken])')
    echo "$free"
}

node() {
    local dir=$1 name=$2
    SLURM_CONF="$dir/slurm.conf" slurmd -N "$name" -f "$dir/slurm.conf" -L "$dir/$name.log"
}

case ${1:-} in
up)
    dir=$(mkdir -p "$2" && cd "$2" && pwd)
    if [ -e /etc/slurm/slurm.conf ]; then
        echo "/etc/slurm/slurm.conf is there: this machine has a Slurm of its own" >&2
        exit 1
    fi
    mkdir -p "$dir/state"
    chmod 755 "$dir"
    dd if=/dev/urandom of="$dir/munge.key" bs=1024 count=1 status=none
    chmod 400 "$dir/munge.key"
    read -r controller first second _ <<<"$(base_port)"
    munged --force --num-threads=2 --key-file="$dir/munge.key" --socket="$dir/munge.socket" \
        --pid-file="$dir/munge.pid" --log-file="$dir/munge.log" --seed-file="$dir/munge.seed"
    cat >"$dir/slurm.conf" <<CONF
ClusterName=lightloom
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmctldPort=$controller
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
# A job that is put back into the queue waits until its credential has expired: 120 seconds by default.
AuthInfo=cred_expire=20,socket=$dir/munge.socket
CredType=cred/munge
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool.%n
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/%n.pid
SlurmctldLogFile=$dir/slurmctld.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,bf_interval=1
ReturnToService=2
SlurmdTimeout=4
InactiveLimit=0
KillWait=1
MessageTimeout=10
JobRequeue=1
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
NodeName=n1 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$first CPUs=1 RealMemory=1000 State=UNKNOWN
NodeName=n2 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$second CPUs=1 RealMemory=1000 State=UNKNOWN
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
    ln -sfn "$dir/slurm.conf" /etc/slurm/slurm.conf
    SLURM_CONF="$dir/slurm.conf" slurmctld -f "$dir/slurm.conf"
    node "$dir" n1
    node "$dir" n2
    ;;
node)
    node "$(cd "$2" && pwd)" "$3"
    ;;
down)
    for name in n1 n2 slurmctld munge; do
        pid=$(cat "$2/$name.pid" 2>/dev/null || true)
        [ -z "$pid" ] || kill "$pid" 2>/dev/null || true
    done
    [ "$(readlink /etc/slurm/slurm.conf)" != "$(cd "$2" && pwd)/slurm.conf" ] || rm /etc/slurm/slurm.conf
    ;;
*)
    sed -n '2,10s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
