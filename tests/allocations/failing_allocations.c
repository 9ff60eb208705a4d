// A library to preload into the engine. It makes chosen memory allocations of the extension fail, and records the
// consequences.
//
// Only allocations with a frame of the extension on their stack count: its own, and those that the engine makes during
// a call of the extension. A script sends commands with OS.set_environment("THICKET_ALLOCATIONS", COMMAND):
//
//   fail N BYTES  fails the N-th allocation from now on of at least that many bytes, counted from 1. With THICKET_TRACE set,
//                 prints its stack and that of a crash to standard error
//   worker N BYTES  the same, but only counts allocations on threads other than the main one
//   stop          no allocation fails any more
//   sweep         for each number in THICKET_SWEEP ("FIRST LAST STEP JOBS"), continues in a forked process in which that
//                 allocation fails, or none for 0. The engine must run without worker threads. Each process writes its output
//                 (N.log) and its result (N.txt) to THICKET_SWEEP_FOLDER
//   end           ends such a process
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <unwind.h>

void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);

enum { most_frames = 48, most_jobs = 16, seconds_of_a_process = 20 };

static atomic_uintptr_t library_begin;
static atomic_uintptr_t library_end;
static atomic_bool armed;
static atomic_long fail_at;
static atomic_size_t least_bytes;
static atomic_bool workers_only;
static atomic_long counted;
static int report = -1; // A file of the sweep; -1 in a process outside of a sweep.

static __thread bool busy;
static __thread const char *stack_end;

static bool in_library(uintptr_t address) { return address >= library_begin && address < library_end; }

// --- Stacks ------------------------------------------------------------------------------------------------------------

typedef struct {
	uintptr_t addresses[most_frames];
	int count;
	bool of_library;
} Stack;

static _Unwind_Reason_Code add_frame(struct _Unwind_Context *context, void *data) {
	Stack *stack = data;
	const uintptr_t address = _Unwind_GetIP(context);
	stack->of_library = stack->of_library || in_library(address);
	stack->addresses[stack->count++] = address;
	return stack->count == most_frames ? _URC_END_OF_STACK : _URC_NO_REASON;
}

static _Unwind_Reason_Code find_library(struct _Unwind_Context *context, void *found) {
	*(bool *)found = in_library(_Unwind_GetIP(context));
	return *(bool *)found ? _URC_END_OF_STACK : _URC_NO_REASON;
}

// Returns true if any word on the stack could be a return address into the library. The check is fast, and returns
// false for nearly all allocations.
static bool may_be_below_library(void) {
	if (stack_end == NULL) {
		pthread_attr_t attributes;
		void *begin = NULL;
		size_t size = 0;
		if (pthread_getattr_np(pthread_self(), &attributes) != 0) {
			return true;
		}
		pthread_attr_getstack(&attributes, &begin, &size);
		pthread_attr_destroy(&attributes);
		stack_end = (const char *)begin + size;
	}
	for (const uintptr_t *word = __builtin_frame_address(0); (const char *)word < stack_end; ++word) {
		if (in_library(*word)) {
			return true;
		}
	}
	return false;
}

static void print_stack(const Stack *stack) {
	for (int index = 0; index < stack->count; ++index) {
		Dl_info info;
		const uintptr_t address = stack->addresses[index];
		if (dladdr((const void *)address, &info) != 0 && info.dli_fname != NULL) {
			dprintf(report, "\t%s 0x%lx\n", info.dli_fname, (unsigned long)(address - (uintptr_t)info.dli_fbase));
		} else {
			dprintf(report, "\t? 0x%lx\n", (unsigned long)address);
		}
	}
}

static void print_here(void) {
	Stack stack = {.count = 0};
	_Unwind_Backtrace(add_frame, &stack);
	print_stack(&stack);
}

// --- Allocations -------------------------------------------------------------------------------------------------------

static bool fails(size_t bytes) {
	if (!armed || busy || bytes < least_bytes || (workers_only && gettid() == getpid())) {
		return false;
	}
	busy = true;
	bool fail = false;
	bool below_library = may_be_below_library();
	if (below_library) {
		below_library = false;
		_Unwind_Backtrace(find_library, &below_library);
	}
	if (below_library && atomic_fetch_add(&counted, 1) + 1 == fail_at) {
		fail = true;
		if (report >= 0) {
			dprintf(report, "failed %zu\n", bytes);
			print_here();
		}
	}
	busy = false;
	return fail;
}

void *malloc(size_t size) {
	if (fails(size)) {
		errno = ENOMEM;
		return NULL;
	}
	return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
	if (fails(count * size)) {
		errno = ENOMEM;
		return NULL;
	}
	return __libc_calloc(count, size);
}

void *realloc(void *block, size_t size) {
	// A block shrinks in place in every C library, so Godot does not expect shrinking to fail.
	if (size > malloc_usable_size(block) && fails(size)) {
		errno = ENOMEM;
		return NULL;
	}
	return __libc_realloc(block, size);
}

// --- The library -------------------------------------------------------------------------------------------------------

static int find_segment(struct dl_phdr_info *info, size_t size, void *data) {
	(void)size;
	if (strstr(info->dlpi_name, "libthicket") == NULL) {
		return 0;
	}
	for (int index = 0; index < info->dlpi_phnum; ++index) {
		const ElfW(Phdr) *header = &info->dlpi_phdr[index];
		if (header->p_type == PT_LOAD && (header->p_flags & PF_X) != 0) {
			library_begin = info->dlpi_addr + header->p_vaddr;
			library_end = library_begin + header->p_memsz;
		}
	}
	return *(int *)data = 1;
}

void *dlopen(const char *path, int mode) {
	static void *(*next)(const char *, int);
	if (next == NULL) {
		next = (void *(*)(const char *, int))dlsym(RTLD_NEXT, "dlopen");
	}
	// With RTLD_DEEPBIND, the library would find the C library's functions before the functions above.
	void *handle = next(path, mode & ~RTLD_DEEPBIND);
	if (path != NULL && strstr(path, "libthicket") != NULL) {
		int found = 0;
		dl_iterate_phdr(find_segment, &found);
	}
	return handle;
}

// --- Processes of a sweep ----------------------------------------------------------------------------------------------

static void on_fatal(int signal_number, siginfo_t *info, void *context) {
	(void)context;
	armed = false;
	busy = true;
	if (signal_number == SIGALRM) {
		dprintf(report, "hang\n");
	} else {
		dprintf(report, "crash %d %p\n", signal_number, info->si_addr);
	}
	print_here();
	_exit(100);
}

static void catch_fatal(void) {
	static const int signals[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGALRM};
	static char room[1 << 16];
	const stack_t other = {.ss_sp = room, .ss_size = sizeof(room)};
	sigaltstack(&other, NULL);
	struct sigaction action = {.sa_sigaction = on_fatal, .sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESETHAND};
	for (size_t index = 0; index < sizeof(signals) / sizeof(*signals); ++index) {
		sigaction(signals[index], &action, NULL);
	}
	alarm(seconds_of_a_process);
}

static int open_file(long number, const char *ending) {
	char path[4096];
	snprintf(path, sizeof(path), "%s/%ld.%s", getenv("THICKET_SWEEP_FOLDER"), number, ending);
	return open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

static void arm(long number, size_t bytes) {
	counted = 0;
	fail_at = number;
	least_bytes = bytes;
	armed = true;
}

static void sweep(void) {
	long first = 0;
	long last = 0;
	long step = 1;
	int jobs = 1;
	const char *wanted = getenv("THICKET_SWEEP");
	if (wanted == NULL || sscanf(wanted, "%ld %ld %ld %d", &first, &last, &step, &jobs) != 4) {
		return;
	}
	int running = 0;
	for (long number = first; number <= last; number += step) {
		for (; running >= jobs; --running) {
			wait(NULL);
		}
		if (fork() == 0) {
			report = open_file(number, "txt");
			const int log = open_file(number, "log");
			dup2(log, STDOUT_FILENO);
			dup2(log, STDERR_FILENO);
			catch_fatal();
			arm(number, 0);
			return;
		}
		++running;
	}
	for (; running > 0; --running) {
		wait(NULL);
	}
	fflush(NULL);
	_exit(0);
}

int setenv(const char *name, const char *value, int overwrite) {
	static int (*next)(const char *, const char *, int);
	if (next == NULL) {
		next = (int (*)(const char *, const char *, int))dlsym(RTLD_NEXT, "setenv");
	}
	if (strcmp(name, "THICKET_ALLOCATIONS") != 0) {
		return next(name, value, overwrite);
	}
	long number = 0;
	size_t bytes = 0;
	workers_only = strncmp(value, "worker", 6) == 0;
	if (sscanf(value, "fail %ld %zu", &number, &bytes) == 2 || sscanf(value, "worker %ld %zu", &number, &bytes) == 2) {
		if (report < 0 && getenv("THICKET_TRACE") != NULL) {
			report = STDERR_FILENO;
			catch_fatal();
			alarm(0);
		}
		arm(number, bytes);
	} else if (strcmp(value, "sweep") == 0) {
		sweep();
	} else {
		armed = false;
		if (report >= 0 && strcmp(value, "end") == 0) {
			dprintf(report, "end %ld\n", counted);
			fflush(NULL);
			_exit(0);
		}
	}
	return 0;
}
