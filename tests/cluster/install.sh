#!/usr/bin/env bash
# Installs what tests of batch systems use: Snakemake with its executor for Slurm, from PyPI into target/cluster/venv, and
# Debian's packages slurm-wlm and munge (as root). Tests run this only where LIGHTLOOM_CLUSTER_SETUP=1; without it, they say
# what is not there and skip.
set -euo pipefail
cd "$(dirname "$0")/../.."

venv=target/cluster/venv
if ! [ -x "$venv/bin/snakemake" ]; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet snakemake snakemake-executor-plugin-slurm
fi
if ! command -v slurmctld >/dev/null; then
    apt-get update --quiet
    DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends slurm-wlm munge
fi
