namespace hybrid {}
