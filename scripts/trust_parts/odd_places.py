"""Places and processes as nobody wants them: closed pipes, full disks, few open files, links, two runs at once, a clock that
goes back. One line, or the same results."""

import os
import resource
import shutil
import signal
import subprocess
import time

CLOCK = """
#include <time.h>
#include <sys/time.h>
static long steps = 0;
static long now(void) { return 2000000000L - 3600 * ++steps; }  /* an hour back with every look */
int clock_gettime(clockid_t clock, struct timespec* t) { (void)clock; t->tv_sec = now(); t->tv_nsec = 0; return 0; }
int gettimeofday(struct timeval* t, void* zone) { (void)zone; t->tv_sec = now(); t->tv_usec = 0; return 0; }
time_t time(time_t* t) { long seconds = now(); if (t) *t = seconds; return seconds; }
"""


def run(trial, large):
    out, cache, digest = trial.whole()
    environments(trial, digest, large)
    closed_descriptors(trial, out, digest)
    pipes(trial, out)
    few_files(trial, digest, large)
    clock_that_goes_back(trial, digest)
    full_disk(trial, out, digest)
    two_at_once(trial, digest)
    things_that_vanish(trial)
    links(trial, out)
    names_of_missions(trial, out, cache, large)
    nobody(trial, out)


def flies_the_same(trial, where, digest, **kwargs):
    """A whole run that ends as ever, or with one line and then as ever."""
    place = trial.fresh("place")
    said = trial.fly(place / "run", place / "cache", **kwargs)
    trial.count("odd places")
    trial.expect(not said.fault(), where, said.fault())
    trial.comes_back(where, place / "run", place / "cache", digest)
    trial.discard(place)
    return said


def locales(trial):
    """German and Turkish made in our own folder, where the system has what they are made of."""
    for name in ("de_DE", "tr_TR"):
        made = shutil.which("localedef") and subprocess.run(["localedef", "-i", name, "-f", "UTF-8", trial.folder / f"{name}.UTF-8"],
                                                            capture_output=True, check=False).returncode == 0
        if not made:
            trial.count("locales that could not be made")


def environments(trial, digest, large):
    locales(trial)
    locale_path = {"LOCPATH": str(trial.folder)}
    for where, env in trial.some({"no HOME": {"HOME": ""}, "a HOME of /dev/null": {"HOME": "/dev/null"}, "no PATH": {"PATH": ""},
                       "no such TMPDIR": {"TMPDIR": "/nowhere"}, "a TMPDIR that is a file": {"TMPDIR": "/dev/null"},
                       "commas in numbers": {"LC_ALL": "de_DE.UTF-8", **locale_path},
                       "Turkish": {"LC_ALL": "tr_TR.UTF-8", **locale_path}, "a locale of nobody": {"LC_ALL": "xx_XX"},
                       "an instruction set of nobody": {"ED3R_SIMD": "avx9000"}, "threads of OpenMP": {"OMP_NUM_THREADS": "-1"},
                       "dynamic threads": {"OMP_DYNAMIC": "true", "OMP_THREAD_LIMIT": "1"}, "a time zone of nobody": {"TZ": "Nowhere/At_All"},
                       "little stack for threads": {"OMP_STACKSIZE": "64k"}}.items(), large):
        said = flies_the_same(trial, where, digest, env=env)
        if where == "an instruction set of nobody":
            trial.expect(said.status == 2, where, str(said))


def closed_descriptors(trial, out, digest):
    """A program whose 0, 1 or 2 is closed opens its own files there; none of them may get its words."""
    for closed in ("0<&-", "1>&-", "2>&-", "1>&- 2>&-", "0<&- 1>&- 2>&-"):
        place = trial.fresh("closed")
        command = ["sh", "-c", f'exec "$@" {closed}', "sh", trial.binary, *map(str, trial.run_arguments(place / "run", place / "cache"))]
        command.remove("--quiet")
        done = subprocess.run(command, capture_output=True, timeout=120, check=False)
        trial.count("odd places")
        trial.expect(done.returncode in (0, 1, 2), f"run with {closed}", f"exit {done.returncode}: {done.stderr[-200:]}")
        trial.comes_back(f"run with {closed}", place / "run", place / "cache", digest)
        trial.discard(place)
    for name in ("digest", "status", "params", "report", "export", "verify"):
        arguments = [trial.binary, name, *([] if name == "params" else [str(out)])]
        if name in ("report", "export"):
            arguments += ["--out", str(trial.fresh("out"))] + (["--no-figures", "--no-missions", "--json"] if name == "report" else ["--csv"])
        for what, redirection in {"a full device": "1>/dev/full", "no stdout": "1>&-"}.items():
            done = subprocess.run(["sh", "-c", f'exec "$@" {redirection}', "sh", *arguments], capture_output=True, timeout=120, check=False)
            trial.count("odd places")
            trial.expect(done.returncode == 1 and len(done.stderr.decode().strip().splitlines()) == 1, f"{name} to {what}",
                         f"exit {done.returncode}: {done.stderr[-200:]}")


def pipes(trial, out):
    """Whoever reads our output may leave: no words, no crash, no hang."""
    exported = trial.fresh("out")
    for name in ("params", f"report {out} --json --no-figures --no-missions --out {trial.fresh('out')}", f"export {out} --csv --out {exported}",
                 f"status {out}"):
        done = subprocess.run(["bash", "-c", f'set -o pipefail; {trial.binary} {name} | head -c 10'], capture_output=True, timeout=120, check=False)
        trial.count("odd places")
        trial.expect(done.returncode in (0, 1, 141) and len(done.stderr.splitlines()) <= 1, f"{name} | head",
                     f"exit {done.returncode}: {done.stderr[-200:]}")


def few_files(trial, digest, large):
    for files in trial.some((20, 14, 12, 10, 8, 6, 5, 4), large):
        flies_the_same(trial, f"{files} open files", digest, limits={resource.RLIMIT_NOFILE: files})
    flies_the_same(trial, "no core, little stack", digest, limits={resource.RLIMIT_STACK: 1 << 20})


def clock_that_goes_back(trial, digest):
    source, shim = trial.folder / "clock.c", trial.folder / "clock.so"
    source.write_text(CLOCK)
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", shim, source], check=True)
    flies_the_same(trial, "a clock that goes back", digest, env={"LD_PRELOAD": str(shim)})


def full_disk(trial, out, digest):
    """A real file system of little room, where mounting one is allowed."""
    for kilobytes in (40, 300, 600):
        place = trial.fresh("disk")
        place.mkdir()
        script = (f'mount -t tmpfs -o size={kilobytes}k none {place} || exit 99; "$@"; status=$?; cp -r {place} {place}-after; exit $status')
        done = subprocess.run(["unshare", "--mount", "sh", "-c", script, "sh", trial.binary,
                               *map(str, trial.run_arguments(place / "run", place / "cache"))], capture_output=True, timeout=120, check=False)
        if done.returncode == 99:
            return trial.count("file systems that could not be mounted")
        trial.count("odd places")
        words = done.stderr.decode().strip()
        trial.expect(done.returncode in (0, 1) and len(words.splitlines()) <= 1, f"a disk of {kilobytes} kB", f"exit {done.returncode}: {words}")
        after = place.with_name(place.name + "-after")
        trial.comes_back(f"a disk of {kilobytes} kB", after / "run", after / "cache", digest)
        report = subprocess.run(["unshare", "--mount", "sh", "-c", script.replace(f"cp -r {place} {place}-after", ":"), "sh", trial.binary, "report",
                                 out, "--no-figures", "--no-missions", "--out", place / "report"], capture_output=True, timeout=120, check=False)
        words = [line for line in report.stderr.decode().splitlines() if not line.startswith("note: ")]
        trial.expect(report.returncode in (0, 1, 2) and len(words) == (report.returncode != 0), f"report to a disk of {kilobytes} kB",
                     f"exit {report.returncode}: {words}")
    return None


def two_at_once(trial, digest):
    place = trial.fresh("two")
    extra = ("--missions", "200")
    _, _, long_digest = trial.whole(extra=extra)
    first = trial.start(*trial.run_arguments(place / "run", place / "cache", extra=extra))
    while not (place / "run" / "results.sqlite").exists() and first.poll() is None:
        time.sleep(0.01)
    time.sleep(0.1)
    second = trial.fly(place / "run", place / "cache", extra=extra)
    trial.expect(second.status == 2 and not second.fault() or first.poll() is not None, "a second run into one directory", str(second))
    for name in ("status", "digest", "verify", "report"):
        said = trial.ed3r(name, place / "run", *(("--no-figures", "--no-missions", "--out", trial.fresh("report")) if name == "report" else ()))
        trial.expect(not said.fault(), f"{name} beside a run", said.fault())
    first.communicate(timeout=300)
    trial.comes_back("two runs into one directory", place / "run", place / "cache", long_digest, extra=extra)
    both = [trial.start(*trial.run_arguments(place / f"both{i}", place / "both-cache")) for i in range(4)]  # one cache for all
    for i, process in enumerate(both):
        words = process.communicate(timeout=300)[1].decode()
        trial.count("runs at once with one cache")
        trial.expect(process.returncode == 0, "four runs with one cache", words)
        trial.expect(trial.digest(place / f"both{i}") == digest, "four runs with one cache", "another digest")


def things_that_vanish(trial):
    """Files and folders that go away while it flies."""
    def remove_run(place):
        shutil.rmtree(place / "run", ignore_errors=True)

    def remove_store(place):
        (place / "run" / "results.sqlite").unlink(missing_ok=True)

    def remove_log(place):
        (place / "run" / "results.sqlite-wal").unlink(missing_ok=True)

    def empty_store(place):
        if (place / "run" / "results.sqlite").exists():
            os.truncate(place / "run" / "results.sqlite", 0)

    def remove_cache(place):
        shutil.rmtree(place / "cache", ignore_errors=True)

    def stop(place):
        pass

    for do in (remove_run, remove_store, remove_log, empty_store, remove_cache, stop):
        place = trial.fresh("vanish")
        process = trial.start(*trial.run_arguments(place / "run", place / "cache", extra=("--missions", "60")))
        while not (place / "run" / "results.sqlite-wal").exists() and process.poll() is None:
            time.sleep(0.005)
        time.sleep(0.1)
        if do is stop:
            process.send_signal(signal.SIGSTOP)
            time.sleep(0.5)
            process.send_signal(signal.SIGCONT)
        do(place)
        words = process.communicate(timeout=300)[1].decode().strip()
        where = f"{do.__name__} while it flies"
        trial.count("odd places")
        trial.expect(process.returncode in (0, 1, 2) and len(words.splitlines()) <= 1, where, f"exit {process.returncode}: {words}")
        if process.returncode == 0 and do in (remove_run, remove_store, empty_store):
            said = trial.ed3r("digest", place / "run")
            trial.fault(where, f"ends with 0; digest then: {said}")
        shutil.rmtree(place, ignore_errors=True)  # a run takes away the folders that it made and nothing is left in


def links(trial, out):
    """Nothing is written through a link, nor over what the program did not make."""
    victim = trial.folder / "victim"
    for name in ("index.html", "data.json", "missions.csv", "table.txt"):
        victim.write_text("mine")
        report = trial.fresh("report")
        trial.ed3r("report", out, "--no-figures", "--no-missions", "--out", report)
        names = {path.name for path in report.iterdir()}
        if name in names:
            (report / name).unlink()
            (report / name).symlink_to(victim)
            said = trial.ed3r("report", out, "--no-figures", "--no-missions", "--out", report)
            trial.count("links")
            trial.expect(victim.read_text() == "mine", f"a link in place of {name}", f"was written through: {said}")
    for kind, arguments in {"export": ("--csv",), "report": ("--no-figures", "--no-missions")}.items():
        folder = trial.fresh("elsewhere")
        folder.mkdir()
        (folder / "mine.csv").write_text("mine")
        link = trial.fresh("link")
        link.symlink_to(folder)
        said = trial.ed3r(kind, out, *arguments, "--out", link)
        trial.count("links")
        trial.expect(not said.fault() and (folder / "mine.csv").read_text() == "mine", f"{kind} --out LINK", f"{said} {said.fault()}")
        place = trial.fresh("export")
        place.mkdir()
        (place / "missions.csv").symlink_to(victim)
        victim.write_text("mine")
        said = trial.ed3r(kind, out, *arguments, "--out", place)
        trial.expect(victim.read_text() == "mine", f"{kind} over a link", f"was written through: {said}")
        for bad in ("/dev/null", "/proc/x", "", victim, "x" * 5000):
            said = trial.ed3r(kind, out, *arguments, "--out", bad)
            trial.count("links")
            trial.expect(said.status in (1, 2) and not said.fault(), f"{kind} --out {str(bad)[:30]!r}", f"{said} {said.fault()}")


def names_of_missions(trial, out, cache, large):
    for mission in trial.some(("rbs/-1", "rbs/12", "rbs/99999999999999999999", "rbs/1e0", "rbs/ 1", "rbs/", "/3", "rbs", "", "../rbs/1", "none/1", "rbs/1/2", "rbs/1\n",
                    "r" * 5000 + "/1", "\udcff/1"), large):
        for command in (("replay",), ("explain", "--step", "1")):
            said = trial.ed3r(command[0], out, mission, *command[1:], "--cache", cache, *(("--out", trial.fresh("out")) if command[0] == "replay" else ()))
            trial.count("odd inputs")
            trial.expect(said.status == 2 and not said.fault(), f"{command[0]} {mission[:20]!r}", f"{said} {said.fault()}")
    for step in trial.some(("0", "-1", "100000", "1e9", "x", "", "99999999999999999999", "010"), large):
        said = trial.ed3r("explain", out, "rbs/1", "--step", step, "--cache", cache)
        trial.count("odd inputs")
        trial.expect(said.status == 2 and not said.fault(), f"explain --step {step!r}", f"{said} {said.fault()}")


def nobody(trial, out):
    """Somebody without rights: reading works in a folder that cannot be written, writing says so."""
    if os.geteuid() != 0 or shutil.which("setpriv") is None:
        return
    place = trial.fresh("read-only")
    shutil.copytree(out, place)
    trial.folder.chmod(0o755)
    as_nobody = ["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups", trial.binary]
    for arguments, statuses in {("digest", place): (0,), ("verify", place): (0,), ("status", place): (0,), ("report", place, "--no-figures", "--no-missions"): (1, 2),
                                ("export", place, "--csv"): (1, 2), ("run", *trial.run_arguments(place, place / "cache", extra=("--missions", "13"))[1:]): (1, 2),
                                ("replay", place, "rbs/1"): (1, 2)}.items():
        done = subprocess.run([*as_nobody, *map(str, arguments)], capture_output=True, timeout=120, check=False)
        trial.count("odd places")
        words = done.stderr.decode().strip()
        trial.expect(done.returncode in statuses and len(words.splitlines()) == (done.returncode != 0), f"{arguments[0]} without rights",
                     f"exit {done.returncode}: {words}")
    for umask in ("777", "000"):
        made = trial.fresh("umask")
        done = subprocess.run(["sh", "-c", f'umask {umask}; exec "$@"', "sh", trial.binary, *map(str, trial.run_arguments(made / "run", made / "cache"))],
                              capture_output=True, timeout=120, check=False)
        trial.count("odd places")
        trial.expect(done.returncode in (0, 1, 2), f"umask {umask}", f"exit {done.returncode}: {done.stderr[-200:]}")
