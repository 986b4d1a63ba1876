"""What `mpmcol` sees of Python in Windows, on another system: for its modules only, not for the libraries that it uses.

`install` makes the import statements of mpmcol's modules find no POSIX-only module, and stand-ins of `os`, `signal`,
`subprocess` and `sys` that lack POSIX-only names and refuse what Windows refuses: opening a folder, renaming onto an
open file. Files opened without O_BINARY get other line ends. Text files without an encoding are an error.
"""

from __future__ import annotations

import builtins
import errno
import importlib
import os
import signal
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import psutil

POSIX_MODULES = ("fcntl", "grp", "posix", "pty", "pwd", "resource", "spwd", "syslog", "termios", "tty")
POSIX_NAMES = {
    "os": """
        O_CLOEXEC O_DIRECTORY O_NOFOLLOW O_NONBLOCK O_SYNC WEXITSTATUS WIFEXITED WIFSIGNALED WNOHANG WTERMSIG chown
        chroot confstr fchdir fchmod fchown fdatasync fork forkpty getegid geteuid getgid getgroups getloadavg
        getpgid getpgrp getpriority getresuid getsid getuid initgroups killpg lchown lockf mkfifo mknod nice openpty
        pathconf pipe2 posix_fadvise posix_fallocate posix_spawn pread pwrite readv register_at_fork
        sched_getaffinity sched_setaffinity sched_yield sendfile setegid seteuid setgid setpgid setpriority setsid
        setuid statvfs sync sysconf tcgetpgrp ttyname uname wait wait3 wait4 waitid writev
    """,
    "signal": """
        SIGALRM SIGBUS SIGCHLD SIGCONT SIGHUP SIGIO SIGKILL SIGPIPE SIGPROF SIGQUIT SIGSTOP SIGSYS SIGTRAP SIGTSTP
        SIGTTIN SIGTTOU SIGURG SIGUSR1 SIGUSR2 SIGVTALRM SIGWINCH SIGXCPU SIGXFSZ alarm getitimer pause pthread_kill
        pthread_sigmask setitimer siginterrupt sigpending sigwait
    """,
    "subprocess": "",
    "sys": "",
    "psutil": "",
}
O_BINARY = 1 << 40


def install() -> None:
    """Replace the import statement of the modules of mpmcol, which must not have been imported yet."""
    assert "mpmcol" not in sys.modules
    stand_ins = _stand_ins()
    real_import = builtins.__import__

    def import_as_in_windows(
        name: str, globals: Mapping[str, Any] | None = None, locals: Any = None, fromlist: Any = (), level: int = 0
    ) -> Any:
        if (globals or {}).get("__name__", "").partition(".")[0] == "mpmcol":
            if name in POSIX_MODULES:
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)
            if name in stand_ins:
                return stand_ins[name]
        return real_import(name, globals, locals, fromlist, level)

    builtins.__import__ = import_as_in_windows
    warnings.filterwarnings("ignore", category=EncodingWarning)  # of libraries
    warnings.filterwarnings("error", category=EncodingWarning, module=r"mpmcol\.")


def _stand_ins() -> dict[str, Any]:
    found: dict[str, Any] = {name: _StandIn(name, names.split()) for name, names in POSIX_NAMES.items()}
    found["sys"].platform = "win32"
    found["signal"].CTRL_BREAK_EVENT = signal.SIGTERM  # stops a process of its own group as SIGBREAK does
    members = {name: number for name, number in signal.Signals.__members__.items() if hasattr(found["signal"], name)}
    found["signal"].Signals = _Signals(members)
    found["subprocess"].CREATE_NEW_PROCESS_GROUP = 0
    found["psutil"].Process = lambda: SimpleNamespace(
        memory_info=lambda: SimpleNamespace(peak_wset=psutil.Process().memory_info().rss)
    )
    _replace_files(found["os"])
    return found


class _Signals(dict[str, signal.Signals]):
    """`signal.Signals` with some members only."""

    @property
    def __members__(self) -> dict[str, signal.Signals]:
        return self

    def __call__(self, number: int) -> signal.Signals:
        return signal.Signals(number)


class _StandIn(ModuleType):
    """A module whose names are those of another one, as they are now, without some."""

    def __init__(self, name: str, hidden: list[str]) -> None:
        super().__init__(name)
        self._real, self._hidden = importlib.import_module(name), frozenset(hidden)

    def __getattr__(self, name: str) -> Any:
        if name in self._hidden:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        return getattr(self._real, name)


def _replace_files(stand_in: Any) -> None:
    """Let `os.open`, `os.write` and `os.replace` behave as in Windows."""
    text_files: set[int] = set()

    def open_file(path: Any, flags: int, mode: int = 0o777) -> int:
        if Path(path).is_dir():
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
        descriptor = os.open(path, flags & ~O_BINARY, mode)
        text_files.discard(descriptor)
        if not flags & O_BINARY:
            text_files.add(descriptor)
        return descriptor

    def write(descriptor: int, data: bytes) -> int:
        if descriptor not in text_files:
            return os.write(descriptor, data)
        os.write(descriptor, bytes(data).replace(b"\n", b"\r\n"))
        return len(data)

    def replace(source: Any, target: Any) -> None:
        if os.path.exists(target) and any(os.path.samefile(file, target) for file in _open_files()):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), target)
        os.replace(source, target)

    stand_in.O_BINARY, stand_in.open, stand_in.write, stand_in.replace = O_BINARY, open_file, write, replace


def _open_files() -> list[str]:
    """The files that this process has open."""
    return [file for file in map(os.path.realpath, Path("/proc/self/fd").glob("*")) if os.path.isfile(file)]
