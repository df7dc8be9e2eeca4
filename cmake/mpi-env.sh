#!/bin/sh
# mpi-env.sh COMMAND...: runs a command with Open MPI settings for one machine, with or without a container or root.
# make demo and every test use it. Settings of the user have priority. Clusters do not need it: see jobs/slurm.
set -eu
default() { eval "export $1=\"\${$1:-$2}\""; }

default OMPI_ALLOW_RUN_AS_ROOT 1
default OMPI_ALLOW_RUN_AS_ROOT_CONFIRM 1
id -un >/dev/null 2>&1 || default HOME /                  # without HOME and passwd entry mpirun crashes
# One worker per core, and the master, which must not share one worker's core: --map-by :oversubscribe --bind-to none.
if command -v prterun >/dev/null; then                    # Open MPI 5 and newer
  case $(mpirun --version) in
    *"(Open MPI) 5."*)
      default PRTE_MCA_rmaps_default_mapping_policy :oversubscribe
      default PRTE_MCA_hwloc_default_binding_policy none ;;
    *)
      default PRTE_MCA_mapby :oversubscribe
      default PRTE_MCA_bindto none ;;
  esac
else
  default OMPI_MCA_rmaps_base_oversubscribe 1
  default OMPI_MCA_hwloc_base_binding_policy none
  default OMPI_MCA_orte_execute_quiet 1                   # no banner of mpirun after the messages of the ranks
fi
default OMPI_MCA_mpi_yield_when_idle 1
default OMPI_MCA_btl_vader_single_copy_mechanism none     # containers forbid process_vm_readv
default OMPI_MCA_pml ob1                                  # no search for network hardware: halves the start-up time
default OMPI_MCA_btl self,vader
exec "$@"
