#!/bin/bash
# Runs @SCENE@ in @SHARDS@ shares by Slurm and merges them. Start it where the scene's path leads to the scene:
#   bash FILE.sh
# Start it again where a share has failed: what is whole is kept, what was begun goes on.
# Options for every job, as a partition or an account, come from the variable SBATCH_OPTIONS.
set -eu

afmsweep=${AFMSWEEP:-@PROGRAM@}
scene=@SCENE@
name=@NAME@
shards=@SHARDS@
cpus=@CPUS@
# How often a share that a signal has ended (killed, out of time, preempted) is queued again.
retries=${RETRIES:-5}
run_options=(@OPTIONS@)
read -r -a options <<< "${SBATCH_OPTIONS:-}"
export afmsweep scene name shards retries

mkdir -p results/slurm
submit() {
  sbatch --parsable --cpus-per-task="$cpus" --open-mode=append "${options[@]}" "$@"
}

prepare=$(submit --job-name="$name-prepare" --output="results/slurm/$name-prepare.log" <<JOB
#!/bin/bash
exec "$afmsweep" prepare "$scene" -o "results/$name.choices.toml" --threads "\$SLURM_CPUS_PER_TASK" ${run_options[@]+"${run_options[@]}"}
JOB
)

# A share is told to end a minute before its time is over, and is then queued again.
array=$(submit --job-name="$name" --output="results/slurm/$name-%a.log" --array="1-$shards" --requeue \
  --dependency="afterok:$prepare" --kill-on-invalid-dep=yes --signal=TERM@60 <<JOB
#!/bin/bash
srun --cpus-per-task="\$SLURM_CPUS_PER_TASK" "$afmsweep" run "$scene" --shard "\$SLURM_ARRAY_TASK_ID/$shards" --resume \
  --choices "results/$name.choices.toml" --threads "\$SLURM_CPUS_PER_TASK" ${run_options[@]+"${run_options[@]}"}
code=\$?
if [ "\$code" -ge 128 ] && [ "\${SLURM_RESTART_COUNT:-0}" -lt $retries ]; then
  scontrol requeue "\${SLURM_ARRAY_JOB_ID}_\$SLURM_ARRAY_TASK_ID" && sleep 60
fi
exit "\$code"
JOB
)

# Whatever became of the shares: it names those that are missing, and the command that makes each.
merge=$(submit --job-name="$name-merge" --output="results/slurm/$name-merge.log" --dependency="afterany:$array" <<JOB
#!/bin/bash
exec "$afmsweep" merge results/$name.*-of-$shards.h5 -o "results/$name.h5" --threads "\$SLURM_CPUS_PER_TASK"
JOB
)

echo "prepare: job $prepare, shares: array $array, merge: job $merge; what they say is in results/slurm"
