/// @file
/// This file says what a shared plumb shows to others. Everything else is hidden, so that its calls stay
/// direct and its names meet no others.
#pragma once

#if defined(__GNUC__)
/// Marks what a static plumb shows too. It is for exceptions, which are recognised across libraries by their
/// type information.
#define PLUMB_VISIBLE __attribute__((visibility("default")))
/// Hides a member of a visible class.
#define PLUMB_HIDDEN __attribute__((visibility("hidden")))
#else
#define PLUMB_VISIBLE
#define PLUMB_HIDDEN
#endif

#if defined(PLUMB_STATIC)  // Set for plumb's own files in a static library; its users need not set it.
/// Marks what is public. A static plumb hides it, so that a shared object which links it exports nothing of
/// it.
#define PLUMB_API
#else
/// Marks what is public. A static plumb hides it, so that a shared object which links it exports nothing of
/// it.
#define PLUMB_API PLUMB_VISIBLE
#endif
