/* Preloaded into Godot for a sanitized build of the extension. The engine loads libraries with RTLD_DEEPBIND. With this flag, a library
 * would call the C library's malloc and pthread functions instead of the sanitizer's. This wrapper of dlopen removes the flag. */
#define _GNU_SOURCE
#include <dlfcn.h>

void *dlopen(const char *path, int flags) {
	static void *(*next)(const char *, int);
	if (!next) {
		next = (void *(*)(const char *, int))dlsym(RTLD_NEXT, "dlopen");
	}
	return next(path, flags & ~RTLD_DEEPBIND);
}
