"""Run directories as nobody should leave them: changed values, exchanged files, other people's shards. Named, or harmless."""

import os
import shutil
import sqlite3

from . import program

# Changes of a store that its readers must name: (what, SQL). The whole store has 12 missions of each arm, runs 0, 1 and, online, 3 to 5.
NAMED = {
    "a movement energy of one more joule": "UPDATE missions SET movement_j = movement_j + 1 WHERE run = 3 AND mission = 3",
    "an energy that is infinite": "UPDATE missions SET total_j = 9e999 WHERE run = 3 AND mission = 3",
    "an energy that is not there": "UPDATE missions SET total_j = NULL WHERE run = 3 AND mission = 3",
    "an outcome that is none": "UPDATE missions SET outcome = 7 WHERE run = 3 AND mission = 3",
    "another outcome": "UPDATE missions SET outcome = 1 - outcome WHERE run = 3 AND mission = 3",
    "an outcome of 2^40": "UPDATE missions SET outcome = 1099511627776 WHERE run = 3 AND mission = 3",
    "a site of another": "UPDATE missions SET site = 1 - site WHERE run = 3",
    "a count of timesteps of -1": "UPDATE missions SET timesteps = -1 WHERE run = 3 AND mission = 3",
    "a mission beyond the plan": "UPDATE missions SET mission = 99 WHERE run = 3 AND mission = 11",
    "a mission below the plan": "UPDATE missions SET mission = -1 WHERE run = 3 AND mission = 0",
    "a run beyond the plan": "UPDATE missions SET run = 9 WHERE run = 5 AND mission = 11",
    "two missions in each other's place": "UPDATE missions SET mission = CASE mission WHEN 3 THEN -4 ELSE -3 END WHERE run = 3 AND mission IN (3, 4);"
                                          "UPDATE missions SET mission = -mission WHERE mission < 0",
    "two arms in each other's place": "UPDATE missions SET run = -run WHERE run IN (3, 4); UPDATE missions SET run = 7 + run WHERE run < 0",
    "a timestep that is gone": "DELETE FROM timesteps WHERE run = 3 AND mission = 3 AND k = 1",
    "timesteps that are gone": "DELETE FROM timesteps WHERE run = 0",
    "a timestep twice": "CREATE TEMP TABLE t AS SELECT * FROM timesteps WHERE run = 3 AND mission = 3 AND k = 1; UPDATE t SET k = 999;"
                        "INSERT INTO timesteps SELECT * FROM t",
    "timesteps in another order": "UPDATE timesteps SET k = -k WHERE run = 3 AND mission = 3",
    "timesteps of another mission": "UPDATE timesteps SET mission = CASE mission WHEN 3 THEN -4 ELSE -3 END WHERE run = 3 AND mission IN (3, 4);"
                                    "UPDATE timesteps SET mission = -mission WHERE mission < 0",
    "a checksum that is empty": "UPDATE missions SET checksum = '' WHERE run = 3 AND mission = 3",
    "a checksum in capitals": "UPDATE missions SET checksum = upper(checksum) WHERE run = 3 AND mission = 3",
    "a failure beyond the plan": "INSERT INTO failures VALUES (99, 0, 0, 0, 'x', 'y')",
    "another seed": "UPDATE recipe SET value = '5' WHERE key = 'seed'",
    "no seed": "DELETE FROM recipe WHERE key = 'seed'",
    "a seed that is no number": "UPDATE recipe SET value = 'four' WHERE key = 'seed'",
    "another name": "UPDATE recipe SET value = 'other' WHERE key = 'sweep'",
    "another plan": "UPDATE recipe SET value = replace(value, 'robot.battery_mah=300', 'robot.battery_mah=301') WHERE key = 'plan'",
    "no plan": "DELETE FROM recipe WHERE key = 'plan'",
    "no checksum of the recipe": "DELETE FROM recipe WHERE key = 'checksum'",
    "an arm of another name": "UPDATE runs SET name = 'ecd2r-x' WHERE run = 5",
    "arms of each other's names": "UPDATE runs SET name = CASE name WHEN 'rbs' THEN 'ecd2r' ELSE 'rbs' END WHERE run IN (3, 5)",
    "an arm less": "DELETE FROM runs WHERE run = 5",
    "an arm of a stage that is none": "UPDATE runs SET stage = 7 WHERE run = 5",
    "an arm of 2^40": "UPDATE runs SET arm = 1099511627776 WHERE run = 5",
    "2^40 missions": "UPDATE stages SET missions = 1099511627776",
    "-1 missions": "UPDATE stages SET missions = -1",
    "no stages": "DELETE FROM stages",
    "another world": "UPDATE files SET content = CAST(replace(CAST(content AS TEXT), 'bend_m: 0', 'bend_m: 1') AS BLOB)",
    "a world that is gone": "DELETE FROM files",
    "another fingerprint": "UPDATE inputs SET fingerprint = 'x'",
    "networks in each other's place": "CREATE TEMP TABLE t AS SELECT * FROM networks WHERE name LIKE 'rc%';"
                                      "UPDATE networks SET model = (SELECT model FROM t WHERE t.sha256 <> networks.sha256) WHERE name LIKE 'rc%'",
    "a network that is gone": "DELETE FROM networks",
    "an empty network": "UPDATE networks SET model = x''",
    "a network of nobody": "UPDATE flown_networks SET sha256 = 'x'",
    "networks of each other's arms": "UPDATE flown_networks SET sha256 = (SELECT sha256 FROM networks WHERE name LIKE 'rc%' AND "
                                     "networks.sha256 <> flown_networks.sha256) WHERE agent = 'rc'",
    "a network of another arm": "UPDATE flown_networks SET run = 3 WHERE run = 5",
    "a failure of a mission that is stored": "INSERT INTO failures VALUES (3, 3, 3, 4, 'x', 'y')",
    "another code": "UPDATE code SET identity = 'x'",
    "format 99": "PRAGMA user_version = 99",
    "format 0": "PRAGMA user_version = 0",
    "format -1": "PRAGMA user_version = -1",
    "format 1": "PRAGMA user_version = 1",
    "text instead of numbers": "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, ') STRICT', ')');"
                               "|UPDATE missions SET total_j = 'one' WHERE run = 3 AND mission = 3",
    "text instead of a number of timesteps": "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, ') STRICT', ')');"
                                             "|UPDATE missions SET timesteps = 'one' WHERE run = 3 AND mission = 3",
    "blobs instead of numbers": "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, 'STRICT, WITHOUT', 'WITHOUT');"
                                "|UPDATE timesteps SET total_j = x'00ff' WHERE run = 3 AND mission = 3",
    "a table that is a view": "ALTER TABLE missions RENAME TO other; CREATE VIEW missions AS SELECT * FROM other WHERE mission < 5",
    "a view without end": "ALTER TABLE missions RENAME TO other; CREATE VIEW missions AS WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL "
                          "SELECT i + 1 FROM n) SELECT other.* FROM n JOIN other",
    "a trigger that writes": "CREATE TRIGGER t AFTER INSERT ON missions BEGIN UPDATE missions SET total_j = 0; END",
    "a table less": "DROP TABLE timesteps",
    "seals that are gone": "DROP VIEW named_missions; ALTER TABLE missions DROP COLUMN seal",
    "checksums that are gone": "DROP VIEW named_missions; ALTER TABLE missions DROP COLUMN checksum; UPDATE missions SET total_j = total_j / 2",
    "checksums of networks that are gone": "ALTER TABLE networks DROP COLUMN checksum",
    "a column less": "DROP VIEW named_missions; ALTER TABLE missions DROP COLUMN site",
}

# What is in no result: (what, SQL). Nothing else may be told.
HARMLESS = {
    "no views": "DROP VIEW named_missions; DROP VIEW named_timesteps",
    "no index": "DROP INDEX missions_by_run",
    "no sessions": "DELETE FROM sessions; DELETE FROM session_notes",
    "no timings": "DELETE FROM timings",
    "a table of somebody": "CREATE TABLE mine (x); INSERT INTO mine VALUES (1)",
    "a host of angle brackets": "UPDATE sessions SET host = '<script>alert(1)</script>'",
    "dates of the year 9999": "UPDATE sessions SET begun_utc = '9999-99-99', ended_utc = 'x'",
}


def run(trial, large):
    out, cache, digest = trial.whole()
    shown = report(trial, out)
    for what, sql in trial.some(NAMED.items(), large):
        named(trial, what, change(trial, out, sql), cache, digest)
    for what, sql in trial.some(HARMLESS.items(), large):
        damaged = change(trial, out, sql)
        trial.count("harmless changes of stores")
        trial.expect(trial.digest(damaged) == digest, what, f"another digest: {trial.digest(damaged)}")
        trial.expect(report(trial, damaged) == shown, what, "another report")
        trial.comes_back(what, damaged, cache, digest)
        trial.discard(damaged)
    missing_missions(trial, out, cache, digest)
    files_in_its_place(trial, out, cache, large)
    write_ahead_logs(trial, out, cache, digest)
    exchanged(trial, out, cache, digest)
    caches(trial, cache, digest, large)


def report(trial, out):
    return trial.ed3r("report", out, "--json", "--no-figures", "--no-missions", "--out", trial.fresh("report")).out


def change(trial, out, sql):
    """A copy of the run whose store this SQL has changed; '|' parts connections."""
    place = trial.fresh("changed")
    shutil.copytree(out, place)
    for part in sql.split("|"):
        database = sqlite3.connect(place / "results.sqlite")
        database.executescript(part)
        database.commit()
        database.close()
    return place


def named(trial, what, damaged, cache, digest):
    """Some reader says no, each in one line; none tells another digest; 'run' neither goes on nor mends by itself."""
    trial.count("changes of stores")
    told = {name: trial.ed3r(name, damaged) for name in ("verify", "digest", "status")}
    told["run"] = trial.fly(damaged, cache)
    for name, said in told.items():
        trial.expect(not said.fault() or (name in ("verify", "status") and said.status == 1), f"{name} with {what}", said.fault())
    trial.expect(told["verify"].status != 0, what, "verify calls it whole")
    trial.expect(told["digest"].status != 0 or told["digest"].out.strip() == digest, what, "digest tells another digest")
    if told["run"].status == 0:
        trial.expect(trial.digest(damaged) == digest, what, "run ends well with another digest")
    trial.discard(damaged)


def missing_missions(trial, out, cache, digest):
    """Missions that are gone are missing, also where the file says that it is finished; they are flown again."""
    damaged = change(trial, out, "DELETE FROM missions WHERE run = 4 AND mission > 8; DELETE FROM timesteps WHERE run = 4 AND mission > 8")
    said = trial.ed3r("status", damaged)
    trial.expect("3" in said.out.splitlines()[-2].split()[-1:], "missions that are gone", f"status: {said.out}")
    trial.comes_back("missions that are gone", damaged, cache, digest)
    trial.discard(damaged)
    damaged = change(trial, out, "DELETE FROM missions WHERE run = 4 AND mission > 8")
    for said in (trial.ed3r("verify", damaged), trial.fly(damaged, cache)):
        trial.expect(said.status in (1, 2), "missions that are gone, but not their timesteps", str(said))
    trial.comes_back("missions that are gone, but not their timesteps", damaged, cache, digest, extra=("--repair",))
    trial.discard(damaged)


def files_in_its_place(trial, out, cache, large):
    """Anything but a store where the store should be."""
    def sparse(path):
        with open(path, "wb") as file:
            file.truncate(10 << 30)

    def half(path):
        content = (out / "results.sqlite").read_bytes()
        path.write_bytes(content[:len(content) // 2])

    things = {"a folder": lambda path: path.mkdir(), "a fifo": os.mkfifo, "a link to itself": lambda path: path.symlink_to(path),
              "a link to nowhere": lambda path: path.symlink_to("nowhere"), "a device": lambda path: path.symlink_to("/dev/zero"),
              "text": lambda path: path.write_text("mission,total_j\n0,1\n" * 1000), "10 GB of nothing": sparse, "half a store": half,
              "the first page": lambda path: path.write_bytes((out / "results.sqlite").read_bytes()[:4096])}
    for what, make in trial.some(things.items(), large):
        place = trial.fresh("place")
        place.mkdir()
        make(place / "results.sqlite")
        for said in (*(trial.ed3r(name, place) for name in ("verify", "digest", "status", "report")), trial.fly(place, cache)):
            trial.count("things in the store's place")
            trial.expect(not said.fault() and said.status in (1, 2), f"{what} in the store's place", str(said) + said.fault())
        trial.discard(place)


def write_ahead_logs(trial, out, cache, digest):
    """Logs and journals that belong to no commit of this store: garbage, another store's, cut short."""
    other, _, _ = trial.whole(extra=("--seed", "5"))
    database = sqlite3.connect(other / "results.sqlite")
    database.executescript("PRAGMA journal_mode = WAL; UPDATE missions SET movement_j = 0;")
    log = (other / "results.sqlite-wal").read_bytes()
    database.close()
    for beside in ("-wal", "-journal"):
        for what, content in {"garbage": trial.random.randbytes(5000), "another store's": log, "half of another's": log[:len(log) // 2],
                              "nothing": b""}.items():
            damaged = change(trial, out, "")
            (damaged / f"results.sqlite{beside}").write_bytes(content)
            where = f"a {beside} of {what}"
            trial.count("logs beside a store")
            said = trial.ed3r("digest", damaged)
            trial.expect(not said.fault() and said.out.strip() in ("", digest), where, f"{said} {said.fault()}")
            again = trial.fly(damaged, cache)
            trial.expect(not again.fault(), where, again.fault())
            if again.status == 0:
                trial.expect(trial.digest(damaged) == digest, where, "another digest")
            trial.discard(damaged)


def exchanged(trial, out, cache, digest):
    """The store of another seed, shards of another sweep, a run merged with itself."""
    other, other_cache, _ = trial.whole(extra=("--seed", "5"))
    said = trial.fly(other, other_cache)
    trial.expect(said.status == 2 and not said.fault(), "the store of another seed", str(said))
    tries = {"shards of two seeds": (trial.fresh("merged"), out, other), "a shard that is not there": (trial.fresh("merged"), out, "nowhere"),
             "a shard that is empty": (trial.fresh("merged"), out, trial.folder), "another seed into a run": (change(trial, out, ""), other),
             "a file as a shard": (trial.fresh("merged"), out, program.SWEEP)}
    for what, arguments in tries.items():
        said = trial.ed3r("merge", *arguments)
        trial.count("merges")
        trial.expect(said.status == 2 and not said.fault(), what, f"{said} {said.fault()}")
        if arguments[0].exists():
            trial.expect(trial.digest(arguments[0]) == digest, what, "the run that was merged into has changed")
    for what, arguments in {"a run with itself": (trial.fresh("merged"), out, out), "a run into itself": (change(trial, out, ""), out, out)}.items():
        said = trial.ed3r("merge", *arguments)
        trial.count("merges")
        trial.expect(said.status == 0 and trial.digest(arguments[0]) == digest, what, str(said))
    mission = "WHERE run = 3 AND mission = 3"
    sql = f"ATTACH '{other / 'results.sqlite'}' AS other; DELETE FROM missions {mission}; DELETE FROM timesteps {mission};" + "".join(
        f"INSERT INTO {table} SELECT * FROM other.{table} {mission};" for table in ("missions", "timesteps"))
    named(trial, "a whole mission of another seed", change(trial, out, sql), cache, digest)
    said = trial.ed3r("diff", out, other)
    trial.expect(said.status in (1, 2) and not (said.status == 2 and said.fault()), "diff of two seeds", str(said))


def caches(trial, cache, digest, large):
    """What may stand where a network should: all is refused, or trained anew with the same result."""
    networks = sorted(path.name for path in cache.iterdir() if path.suffix == ".rfnn")
    rc = [name for name in networks if name.startswith("rc")]

    def swap(place):
        (place / rc[0]).rename(place / "t")
        (place / rc[1]).rename(place / rc[0])
        (place / "t").rename(place / rc[1])

    def instead(make):
        def do(place):
            (place / rc[0]).unlink()
            make(place / rc[0])
        return do

    changes = {"networks in each other's place": swap, "an RC's network for the robot's": lambda place: shutil.copy(place / rc[0], place / networks[-1]),
               "an empty file": instead(lambda path: path.touch()), "a folder": instead(lambda path: path.mkdir()), "a fifo": instead(os.mkfifo),
               "a device": instead(lambda path: path.symlink_to("/dev/zero")), "a link in a ring": instead(lambda path: path.symlink_to(path.name)),
               "half a file": lambda place: os.truncate(place / rc[0], 30_000), "nothing": lambda place: (place / rc[0]).unlink()}
    for what, make in trial.some(changes.items(), large):
        place, run_directory = trial.fresh("cache"), trial.fresh("run")
        shutil.copytree(cache, place)
        make(place)
        said = trial.fly(run_directory, place)
        trial.count("things in a network's place")
        trial.expect(not said.fault(), f"{what} in a network's place", said.fault())
        if said.status == 0:
            trial.expect(trial.digest(run_directory) == digest, f"{what} in a network's place", "another digest")
        trial.discard(place, run_directory)
