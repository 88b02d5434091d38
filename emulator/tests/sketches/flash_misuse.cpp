// Breaks one rule of the flash module for each key.
#include <Arduino.h>
#include <avr/eeprom.h>

static const uint32_t SECTOR = 0x30000;

FASTRUN __attribute__((noinline)) static void launch() {
  FTFL_FSTAT = FTFL_FSTAT_CCIF;
  while (!(FTFL_FSTAT & FTFL_FSTAT_CCIF)) {
  }
}

static void load(uint8_t code, uint32_t address) {
  FTFL_FCCOB0 = code;
  FTFL_FCCOB1 = address >> 16;
  FTFL_FCCOB2 = address >> 8;
  FTFL_FCCOB3 = address;
}

FASTRUN __attribute__((noinline)) static void twice() {
  FTFL_FSTAT = FTFL_FSTAT_CCIF;
  FTFL_FSTAT = FTFL_FSTAT_CCIF;
}

static void misuse(char key) {
  __disable_irq();
  switch (key) {
    case 'c':  // no such command
      load(0x77, SECTOR);
      launch();
      break;
    case 'a':  // not aligned
      load(0x06, SECTOR + 2);
      launch();
      break;
    case 'o':  // outside
      load(0x09, 0x40000);
      launch();
      break;
    case 'p':  // protected
      FTFL_FPROT3 = 0xFE;
      load(0x09, 0x1000);
      launch();
      break;
    case 'b':  // busy
      load(0x09, SECTOR);
      twice();
      break;
    case 'n':  // not erased
      load(0x06, SECTOR);
      FTFL_FCCOB4 = 0;
      launch();
      launch();
      break;
    case 'e':  // error flags left standing
      load(0x77, SECTOR);
      launch();
      load(0x09, SECTOR);
      launch();
      break;
    case 'w':  // from flash, while it is erased
      load(0x09, SECTOR);
      FTFL_FSTAT = FTFL_FSTAT_CCIF;
      while (!(FTFL_FSTAT & FTFL_FSTAT_CCIF)) {
      }
      break;
    case 's':  // the sector with the configuration field
      load(0x09, 0);
      launch();
      break;
    case 'r':  // EEPROM before it is ready
      __enable_irq();
      eeprom_initialize();
      *(volatile uint8_t *)0x14000010 = 1;
      *(volatile uint8_t *)0x14000011 = 2;
      break;
    case 'f':  // EEPROM without a partition
      load(0x81, 0);
      FTFL_FCCOB1 = 0;
      launch();
      break;
    case 't':  // a store to flash
      *(volatile uint32_t *)SECTOR = 0;
      break;
  }
  __enable_irq();
}

void setup() {
  while (!Serial) {
  }
  Serial.println("ready");
}

void loop() {
  if (Serial.available()) misuse(Serial.read());
}
