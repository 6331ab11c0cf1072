/* Checks in C: a function that checks returns null, or the line and the text of what failed. */
#ifndef XGC_TEST_TRY_H
#define XGC_TEST_TRY_H

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)
#define HOLDS(what)                                                                                                    \
    do {                                                                                                               \
        if (!(what)) return __FILE__ ":" TEXT(__LINE__) ": " #what;                                                    \
    } while (0)
#define TRY(call) HOLDS((call).code == XGC_OK)
#define REFUSED(call) HOLDS((call).code == XGC_BAD_ARGUMENT)

#endif
