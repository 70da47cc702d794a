#pragma once

/// What a shared plumb shows to others. Everything else is hidden, so that its calls stay direct and its
/// names meet no others.
///
/// PLUMB_VISIBLE is for exceptions, which are recognised across libraries by their type information.
/// PLUMB_API is for all else that is public; a static plumb compiles it away, so that a shared object that
/// links it exports nothing of it. PLUMB_HIDDEN takes a member of a class out again.
#if defined(__GNUC__)
#define PLUMB_VISIBLE __attribute__((visibility("default")))
#define PLUMB_HIDDEN __attribute__((visibility("hidden")))
#else
#define PLUMB_VISIBLE
#define PLUMB_HIDDEN
#endif

#if defined(PLUMB_STATIC)  // plumb's own files of a static library; those of its users need not set it
#define PLUMB_API
#else
#define PLUMB_API PLUMB_VISIBLE
#endif
