// SPDX-License-Identifier: Apache-2.0
// Objects of static storage in this library, and in the libraries inside it, are never destroyed. Applications can exit without
// destroying their devices, while the thread of the link worker still uses tables of the check.
//
// The compiler registers the destructors of such objects with __cxa_atexit. This definition is hidden, so it replaces the one of the
// C library only inside this library.
extern "C" __attribute__((visibility("hidden"))) int __cxa_atexit(void (*)(void*), void*, void*) { return 0; }
