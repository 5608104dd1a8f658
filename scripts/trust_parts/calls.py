"""System calls that fail: the n-th one on the run's files, for every n; files that may not grow; little memory.

The program may end with one line, or go on; never with other results, and the same command brings the undisturbed digest
once the disk is well again.
"""

import errno
import pathlib
import resource
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parent / "failing_calls.c"
ERRORS = (errno.ENOSPC, errno.EIO, errno.EACCES)


def run(trial, large, options):
    _, _, digest = trial.whole()
    shim = trial.folder / "failing_calls.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", shim, SOURCE, "-ldl"], check=True)
    total = calls_of_a_run(trial, shim)
    trial.count("calls of a run", total)
    stride = options.stride or (1 if large else max(1, total // 12))
    for n in range(1 + trial.random.randrange(stride), total + 1, stride):
        failing_call(trial, shim, n, digest)
    for size in sizes(large):
        small_files(trial, size, digest)
    for megabytes in memories(large):
        little_memory(trial, megabytes, digest)


def shim_environment(shim, under, fail_at, error=errno.EIO, sticky=False):
    return {"LD_PRELOAD": str(shim), "TRUST_UNDER": str(under), "TRUST_FAIL_AT": str(fail_at), "TRUST_ERRNO": str(error),
            **({"TRUST_STICKY": "1"} if sticky else {})}


def calls_of_a_run(trial, shim):
    place, count = trial.fresh("counted"), trial.folder / "count"
    said = trial.fly(place / "run", place / "cache", env={**shim_environment(shim, place, 0), "TRUST_COUNT": str(count)})
    if said.status != 0:
        raise RuntimeError(f"the run under the shim fails: {said}")
    trial.discard(place)
    return int(count.read_text())


def failing_call(trial, shim, n, digest):
    place, error, sticky = trial.fresh("failing"), trial.random.choice(ERRORS), trial.random.random() < 0.5
    where = f"call {n} fails with {errno.errorcode[error]}{', and all after it' if sticky else ''}"
    said = trial.fly(place / "run", place / "cache", env=shim_environment(shim, place, n, error, sticky))
    trial.count("failing calls")
    judge(trial, where, said, place, digest)


def judge(trial, where, said, place, digest):
    trial.count("went on" if said.status == 0 else "ended with a line")
    if trial.expect(not said.fault(), where, said.fault()):
        if said.status == 0:
            trial.expect((found := trial.digest(place / "run")) == digest, where, f"exit 0 with another digest: {found}")
    trial.comes_back(where, place / "run", place / "cache", digest)
    trial.discard(place)


def sizes(large):
    return (4096, 16384, 40000, 65536, 100000, 200000, 400000, 600000) if large else (40000, 300000)


def small_files(trial, size, digest):
    place = trial.fresh("small")
    said = trial.fly(place / "run", place / "cache", limits={resource.RLIMIT_FSIZE: size})
    trial.count("limits of file size")
    trial.expect(said.status != 0, f"files of {size} bytes", "exit 0, though the store cannot fit")
    judge(trial, f"files of {size} bytes", said, place, digest)


def memories(large):
    return (150, 200, 250, 300, 350, 400, 450, 500, 600, 700, 800, 900, 1000, 1200, 1400) if large else (400, 900)


def little_memory(trial, megabytes, digest):
    place, where = trial.fresh("memory"), f"{megabytes} MB of address space"
    # Where the system's BLAS is OpenBLAS it takes 128 MB for each of its own threads before the program begins, and waits without end
    # where it gets none.
    said = trial.fly(place / "run", place / "cache", env={"OPENBLAS_NUM_THREADS": "1"}, limits={resource.RLIMIT_AS: megabytes << 20})
    trial.count("limits of memory")
    if said.status == 127 or "error while loading shared libraries" in said.err:
        trial.count("too little memory for the loader")
        return trial.discard(place)
    judge(trial, where, said, place, digest)
