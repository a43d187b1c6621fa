#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# status.sh JOB: prints running, success or failed, as Snakemake's --cluster-status wants it.
# Without it Snakemake never learns of jobs that were killed.
set -uo pipefail

job=${1%%;*} # sbatch --parsable adds ";cluster" where there are several
answer=$(LC_ALL=C scontrol --oneliner show job "$job" 2>&1)
state=$(grep -oP '(?<= JobState=)\w+' <<<"$answer")
# The controller forgets a job some minutes after its end, the accounting, if there is one, does not.
[[ $state ]] || state=$(sacct --noheader --allocations --parsable2 --format=State --jobs="$job" 2>/dev/null | tail -n 1)

case $state in
COMPLETED) echo success ;;
BOOT_FAIL | CANCELLED* | DEADLINE | FAILED | NODE_FAIL | OUT_OF_MEMORY | PREEMPTED | REVOKED | TIMEOUT) echo failed ;;
'')
    # Nobody knows the job: give it up. Nobody answers: ask again later.
    if [[ $answer == *"Invalid job id"* ]]; then echo failed; else echo running; fi
    ;;
*) echo running ;;
esac
