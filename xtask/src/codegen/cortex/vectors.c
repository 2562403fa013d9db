/* Where a Cortex-M begins: the stack, and newlib's start, which asks the debugger for input and output. */
extern void _start(void);
extern char __stack;

struct vectors {
    const void *stack;
    void (*reset)(void);
    void (*others[14])(void);
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {&__stack, _start, {0}};
