/* A disk that fails: loaded before the C library, it lets one chosen write, sync, rename or truncation in a folder fail.

   fault_arm(folder, step, error) begins to count; step 0 only counts. fault_count() tells the steps so far. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static char folder[4096], failed[4096];
static int chosen, error_number, count;

void fault_arm(const char *where, int step, int error)
{
    snprintf(folder, sizeof folder, "%s", where);
    failed[0] = 0, chosen = step, error_number = error, count = 0;
}
int fault_count(void) { return count; }
const char *fault_where(void) { return failed; }

static int fails_at(const char *path, const char *what)
{
    if (!folder[0] || strncmp(path, folder, strlen(folder)) || __sync_add_and_fetch(&count, 1) != chosen) return 0;
    snprintf(failed, sizeof failed, "%s %.3000s", what, path);
    errno = error_number;
    return 1;
}
static int fails(int fd, const char *what)
{
    char link[64], path[4096];
    int kept = errno;
    if (!folder[0]) return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t length = readlink(link, path, sizeof path - 1);
    errno = kept;
    if (length < 0) return 0;
    path[length] = 0;
    return fails_at(path, what);
}
#define REAL(result, name, ...) static result (*real)(__VA_ARGS__); if (!real) real = dlsym(RTLD_NEXT, #name)

ssize_t write(int fd, const void *data, size_t size)
{ REAL(ssize_t, write, int, const void *, size_t); return fails(fd, "write") ? -1 : real(fd, data, size); }
ssize_t pwrite(int fd, const void *data, size_t size, off_t at)
{ REAL(ssize_t, pwrite, int, const void *, size_t, off_t); return fails(fd, "pwrite") ? -1 : real(fd, data, size, at); }
ssize_t pwrite64(int fd, const void *data, size_t size, off64_t at)
{ REAL(ssize_t, pwrite64, int, const void *, size_t, off64_t); return fails(fd, "pwrite") ? -1 : real(fd, data, size, at); }
size_t fwrite(const void *data, size_t size, size_t many, FILE *file)
{ REAL(size_t, fwrite, const void *, size_t, size_t, FILE *); return fails(fileno(file), "fwrite") ? 0 : real(data, size, many, file); }
int fsync(int fd) { REAL(int, fsync, int); return fails(fd, "fsync") ? -1 : real(fd); }
int fdatasync(int fd) { REAL(int, fdatasync, int); return fails(fd, "fdatasync") ? -1 : real(fd); }
int ftruncate(int fd, off_t size) { REAL(int, ftruncate, int, off_t); return fails(fd, "ftruncate") ? -1 : real(fd, size); }
int ftruncate64(int fd, off64_t size) { REAL(int, ftruncate64, int, off64_t); return fails(fd, "ftruncate") ? -1 : real(fd, size); }
int rename(const char *from, const char *to)
{ REAL(int, rename, const char *, const char *); return fails_at(to, "rename") ? -1 : real(from, to); }
int renameat(int a, const char *from, int b, const char *to)
{ REAL(int, renameat, int, const char *, int, const char *); return fails_at(to, "rename") ? -1 : real(a, from, b, to); }
