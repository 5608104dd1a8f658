// Runs a command and does something at its n-th system call of a kind, seen from outside (ptrace), so that no library can hide a call:
//   faulty_calls REPORT KIND N ACTION COMMAND...
// KIND    one of the names below, or "any"
// N       which of them, counted from 1 after the loader has linked the program; "N+" for that one and all after it
// ACTION  none, error=NUMBER, short (half of what was asked for), signal=NUMBER, hold (until REPORT.held is gone)
// REPORT  gets "hit CALL PATH" where it happened, and how many calls of each kind there were
// The exit status is the command's. 126: tracing is not allowed here.
#define _GNU_SOURCE
#include <elf.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum Names { kNone, kFirst, kSecond, kDescriptor };  // where a call says which file it is about

static const struct Call {
  int number;
  const char* kind;
  enum Names names;
} calls[] = {
    {SYS_open, "open", kFirst},          {SYS_openat, "open", kSecond},     {SYS_read, "read", kDescriptor},
    {SYS_readv, "read", kDescriptor},    {SYS_pread64, "pread", kDescriptor}, {SYS_write, "write", kDescriptor},
    {SYS_writev, "write", kDescriptor},  {SYS_pwrite64, "pwrite", kDescriptor}, {SYS_fsync, "sync", kDescriptor},
    {SYS_fdatasync, "sync", kDescriptor}, {SYS_rename, "rename", kFirst},   {SYS_renameat, "rename", kSecond},
    {SYS_renameat2, "rename", kSecond},  {SYS_unlink, "unlink", kFirst},    {SYS_unlinkat, "unlink", kSecond},
    {SYS_rmdir, "unlink", kFirst},       {SYS_truncate, "truncate", kFirst}, {SYS_ftruncate, "truncate", kDescriptor},
    {SYS_mmap, "mmap", kNone},           {SYS_mremap, "mmap", kNone},       {SYS_brk, "brk", kNone},
    {SYS_fcntl, "lock", kDescriptor},    {SYS_flock, "lock", kDescriptor},  {SYS_mkdir, "mkdir", kFirst},
    {SYS_mkdirat, "mkdir", kSecond},     {SYS_getdents64, "readdir", kDescriptor}, {SYS_stat, "stat", kFirst},
    {SYS_lstat, "stat", kFirst},         {SYS_fstat, "stat", kDescriptor},  {SYS_newfstatat, "stat", kSecond},
    {SYS_statx, "stat", kSecond},        {SYS_close, "close", kDescriptor}, {SYS_access, "access", kFirst},
    {SYS_faccessat, "access", kSecond},  {SYS_readlink, "access", kFirst},  {SYS_lseek, "seek", kDescriptor},
    {SYS_link, "rename", kFirst},        {SYS_chmod, "chmod", kFirst},      {SYS_fchmod, "chmod", kDescriptor},
    {SYS_clone, "thread", kNone},        {SYS_clone3, "thread", kNone},     {SYS_getrandom, "random", kNone},
};
enum { kCalls = sizeof calls / sizeof *calls };

static long seen[kCalls], counted;
static int begun, hit;
static const char *report_path, *kind;
static char action[32], where[512];
static long first, value;
static int from_then_on;

static void TraceMe(char** command) {
  struct sock_filter filter[kCalls + 3];
  filter[0] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
  for (int i = 0; i < kCalls; ++i)
    filter[1 + i] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, calls[i].number, kCalls - i, 0);
  filter[kCalls + 1] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  filter[kCalls + 2] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRACE);
  const struct sock_fprog program = {kCalls + 3, filter};
  if (ptrace(PTRACE_TRACEME, 0, 0, 0) != 0 || raise(SIGSTOP) != 0 || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
    _exit(126);
  execvp(command[0], command);
  _exit(127);
}

static unsigned long Entry(pid_t child) {  // where the loader jumps to when it has linked everything
  char path[64];
  Elf64_auxv_t pair = {0};
  snprintf(path, sizeof path, "/proc/%d/auxv", child);
  FILE* file = fopen(path, "r");
  while (file != NULL && fread(&pair, sizeof pair, 1, file) == 1 && pair.a_type != AT_ENTRY) {}
  if (file != NULL) fclose(file);
  return pair.a_un.a_val;
}

static void TellPlace(pid_t child, const struct Call* call, const struct user_regs_struct* now) {
  char path[400] = "";
  if (call->names == kDescriptor) {
    char link[64];
    snprintf(link, sizeof link, "/proc/%d/fd/%d", child, (int)now->rdi);
    const ssize_t size = readlink(link, path, sizeof path - 1);
    path[size < 0 ? 0 : size] = '\0';
  } else if (call->names != kNone) {
    const struct iovec here = {path, sizeof path - 1};
    const struct iovec there = {(void*)(call->names == kFirst ? now->rdi : now->rsi), sizeof path - 1};
    if (process_vm_readv(child, &here, 1, &there, 1, 0) < 0) strcpy(path, "?");
  }
  snprintf(where, sizeof where, "%s(%d) %s", call->kind, call->number, path);
}

static void Hold(void) {
  char held[4096];
  snprintf(held, sizeof held, "%s.held", report_path);
  close(open(held, O_CREAT | O_WRONLY, 0600));
  while (access(held, F_OK) == 0) nanosleep(&(struct timespec){0, 2000000}, NULL);
}

// Lets the call happen with other arguments, and gives the caller its registers back, which it may go on using. `told`: what it is told instead.
static void Happen(pid_t child, struct user_regs_struct* changed, const struct user_regs_struct* before, const long* told) {
  struct user_regs_struct after;
  int status, forward = 0;
  ptrace(PTRACE_SETREGS, child, 0, changed);
  do {
    ptrace(PTRACE_SYSCALL, child, 0, forward);
    if (waitpid(child, &status, __WALL) < 0 || !WIFSTOPPED(status)) return;
    forward = WSTOPSIG(status);
  } while (forward != (SIGTRAP | 0x80));
  ptrace(PTRACE_GETREGS, child, 0, &after);
  after.rdi = before->rdi;
  after.rdx = before->rdx;
  if (told != NULL) after.rax = (unsigned long)*told;
  ptrace(PTRACE_SETREGS, child, 0, &after);
}

static void Act(pid_t child, pid_t process, const struct Call* call, struct user_regs_struct* now) {
  const struct user_regs_struct before = *now;
  if (strcmp(action, "hold") == 0) {
    Hold();
  } else if (strcmp(action, "signal") == 0) {
    kill(process, (int)value);
  } else if (strcmp(action, "short") == 0) {
    now->rdx = now->rdx > 1 ? now->rdx / 2 : now->rdx;
    Happen(child, now, &before, NULL);
  } else if (strcmp(action, "error") == 0) {
    const long told = -value;
    if (call->number == SYS_close) {  // a descriptor is closed whatever close() returns
      Happen(child, now, &before, &told);
    } else if (call->number == SYS_brk) {
      now->rdi = 0;  // asks where the end is, which is how it says no
      Happen(child, now, &before, NULL);
    } else {
      now->orig_rax = (unsigned long)-1;
      now->rax = (unsigned long)told;
      ptrace(PTRACE_SETREGS, child, 0, now);
    }
  }
}

static void Call(pid_t child, pid_t process) {
  struct user_regs_struct now;
  if (!begun || ptrace(PTRACE_GETREGS, child, 0, &now) != 0) return;
  const struct Call* call = calls;
  while (call < calls + kCalls && call->number != (int)now.orig_rax) ++call;
  if (call == calls + kCalls) return;
  const int command = (int)now.rsi;
  if (call->number == SYS_fcntl && command != F_SETLK && command != F_SETLKW && command != F_GETLK) return;
  if (strcmp(call->kind, "write") == 0 && now.rdi == 2) return;  // whoever cannot speak cannot tell
  ++seen[call - calls];
  if (strcmp(kind, "any") != 0 && strcmp(kind, call->kind) != 0) return;
  ++counted;
  if (first == 0 || (from_then_on ? counted < first : counted != first)) return;
  if (!hit++) TellPlace(child, call, &now);
  Act(child, process, call, &now);
}

static void Report(void) {
  FILE* out = fopen(report_path, "w");
  if (out == NULL) return;
  if (hit) fprintf(out, "hit %s\n", where);
  for (int i = 0; i < kCalls; ++i) fprintf(out, "calls %s %ld\n", calls[i].kind, seen[i]);
  fclose(out);
}

int main(int count, char** arguments) {
  if (count < 6) return 126;
  report_path = arguments[1];
  kind = arguments[2];
  first = atol(arguments[3]);
  from_then_on = strchr(arguments[3], '+') != NULL;
  sscanf(arguments[4], "%31[a-z]=%ld", action, &value);
  const pid_t process = fork();
  if (process == 0) TraceMe(arguments + 5);
  int status, result = 126, stopped_once = 0;
  unsigned long entry = 0;
  long old = 0;
  while (1) {
    const pid_t child = waitpid(-1, &status, __WALL);
    if (child < 0) break;
    if (!WIFSTOPPED(status)) {
      if (child == process) result = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
      continue;
    }
    const int sent = WSTOPSIG(status), event = status >> 16;
    long forward = 0;
    if (child == process && sent == SIGSTOP && !stopped_once) {
      stopped_once = 1;
      ptrace(PTRACE_SETOPTIONS, child, 0, PTRACE_O_TRACESECCOMP | PTRACE_O_TRACEEXEC | PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK |
                                              PTRACE_O_TRACEVFORK | PTRACE_O_EXITKILL | PTRACE_O_TRACESYSGOOD);
    } else if (event == PTRACE_EVENT_EXEC && child == process && entry == 0) {
      entry = Entry(child);
      old = ptrace(PTRACE_PEEKTEXT, child, entry, 0);
      ptrace(PTRACE_POKETEXT, child, entry, (old & ~0xffL) | 0xcc);
    } else if (event == PTRACE_EVENT_SECCOMP) {
      Call(child, process);
    } else if (event == 0 && sent == SIGTRAP && !begun) {
      struct user_regs_struct now;
      ptrace(PTRACE_GETREGS, child, 0, &now);
      now.rip = entry;
      ptrace(PTRACE_POKETEXT, child, entry, old);
      ptrace(PTRACE_SETREGS, child, 0, &now);
      begun = 1;
    } else if (event == 0 && sent != SIGSTOP && sent != (SIGTRAP | 0x80)) {
      forward = sent;
    }
    ptrace(PTRACE_CONT, child, 0, forward);
  }
  Report();
  if (result < 0) {
    signal(-result, SIG_DFL);
    kill(getpid(), -result);
  }
  return result;
}
